// A user's own effect, from the one file of samples/own-effect: known to models, hidden in data, named and measured.

#include <gtest/gtest.h>

#include "identify/diagnosis/diagnose.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "tests/pipeline/heavy_beam.h"

namespace palpate::pipeline {
namespace {

constexpr double hidden = 1e-5;  // [N/mm^3]: next to 3 E I / L^3 over the beam's skin, it halves what the end moves

/// The beam's own readings, embedded in something soft.
identify::MeasurementSet embedded_beam() {
    identify::MeasurementSet set = heavy_beam(false);
    identify::ModelSetting setting{.law = 2, .theta = Eigen::Vector2d(std::log(1.0), std::log(0.1)), .effects = {}};
    setting.effects = skeleton::make_physics({"embedding", {{"stiffness", hidden, "N/mm^3"}}});
    set.position_noise = 0.02;
    read_beam(set, setting, Vec3::Zero(), 11);
    return set;
}

TEST(OwnEffect, IsInTheCatalogueAndInTheModelsPhysics) {
    EXPECT_EQ(identify::find_effect("embedding")->name(), "embedding");
    EXPECT_EQ(skeleton::make_physics({"embedding", {{"stiffness", 1, "N/mm^3"}}}).points.size(), 1);
    EXPECT_THROW(skeleton::make_physics({"embedding", {{"stiffness", -1, "N/mm^3"}}}), InvalidInput);
}

TEST(OwnEffect, IsNamedOnDataThatHideIt) {
    const identify::MeasurementSet set = embedded_beam();
    const Reference reference = make_reference(set, 14);
    const identify::Diagnosis found = identify::diagnose(*reference.body, set, {});
    EXPECT_EQ(found.verdict, identify::Verdict::missing_effect);
    ASSERT_EQ(found.explanation, std::vector<std::string>{"embedding"});
    const identify::EffectEstimate estimate = found.explained->estimate("embedding");
    // The coarser mesh costs a few per cent, the noise less.
    EXPECT_NEAR(estimate.effect.parameters[0].value, hidden, 0.1 * hidden);
}

TEST(OwnEffect, IsNotMistakenForAnotherWhereItIsLeftOut) {
    identify::DiagnoseOptions without;
    without.without = {"embedding"};
    const identify::MeasurementSet set = embedded_beam();
    const Reference reference = make_reference(set, 14);
    EXPECT_TRUE(identify::diagnose(*reference.body, set, without).explanation.empty());
}

}  // namespace
}  // namespace palpate::pipeline
