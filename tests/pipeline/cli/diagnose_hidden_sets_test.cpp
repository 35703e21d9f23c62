// A small part of the benchmark of hidden effects (tests/bench/diagnosis_bench.cpp runs it all): sets that CalculiX
// made, on other meshes than ours.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "identify/diagnosis/diagnose.h"
#include "pipeline/body/reference_body.h"

namespace palpate::pipeline {
namespace {

struct Hidden {
    std::string set;
    std::vector<std::string> effects;
};

std::ostream& operator<<(std::ostream& out, const Hidden& hidden) { return out << hidden.set; }

class HiddenSet : public ::testing::TestWithParam<Hidden> {};

TEST_P(HiddenSet, KeepsWhatItPromises) {
    const char* data = std::getenv("PALPATE_DATA");
    if (!data) GTEST_SKIP() << "PALPATE_DATA names no folder of measurement sets";
    const auto set = identify::read_measurement_set(std::filesystem::path(data) / "hidden" / GetParam().set);
    const Reference reference = make_reference(set, 0);
    ASSERT_TRUE(reference.body) << reference.why_none;
    identify::DiagnoseOptions options;
    options.refit.threads = 2;
    const identify::Diagnosis found = identify::diagnose(*reference.body, set, options);
    EXPECT_EQ(found.verdict,
              GetParam().effects.empty() ? identify::Verdict::adequate : identify::Verdict::missing_effect);
    EXPECT_THAT(found.explanation, ::testing::UnorderedElementsAreArray(GetParam().effects));
    EXPECT_LE(found.best().whitened_rms, 1.1);
}

INSTANTIATE_TEST_SUITE_P(OfCalculix, HiddenSet,
                         ::testing::Values(Hidden{"ell-none", {}},
                                           Hidden{"ell-compliant-support", {"compliant-support"}},
                                           Hidden{"finger-force-gain", {"force-gain"}},
                                           Hidden{"kidney-gravity", {"gravity"}}),
                         [](const auto& tested) {
                             std::string name = tested.param.set;
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

}  // namespace
}  // namespace palpate::pipeline
