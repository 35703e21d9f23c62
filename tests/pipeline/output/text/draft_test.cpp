#include "pipeline/output/text/draft.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "tests/messages.h"
#include "tests/places.h"

namespace palpate::pipeline {
namespace {

const std::filesystem::path drafts = std::filesystem::path(samples_folder) / "../tests/pipeline/output/text/drafts";

std::vector<skeleton::EffectParameter> place() {
    return {{"cx", 29.38114, "mm"}, {"cy", -1.97537, "mm"}, {"cz", -2.828, "mm"}, {"radius", 9.28, "mm"}};
}
skeleton::EffectRecord force() {
    skeleton::EffectRecord effect{"local-force", place()};
    for (const auto& [name, value] : {std::pair{"fx", -0.03}, {"fy", 0.0}, {"fz", 0.04}})
        effect.parameters.push_back({name, value, "N"});
    return effect;
}
skeleton::EffectRecord springs() {
    skeleton::EffectRecord effect{"local-springs", place()};
    effect.parameters.push_back({"stiffness", 0.055, "N/mm"});
    return effect;
}

skeleton::EffectRecord swelling() {
    skeleton::EffectRecord effect{"local-swelling", place()};
    effect.parameters.push_back({"growth", -0.08, "1"});
    return effect;
}

/// PALPATE_UPDATE=1 writes the files. They are compiled and tried by drafted_effects_tests.
void expect_draft(const skeleton::EffectRecord& effect, const std::string& name) {
    const std::filesystem::path file = drafts / (name + ".cc");
    const std::string text = draft_of(effect, name);
    if (std::getenv("PALPATE_UPDATE")) mesh::write_text(file, text);
    EXPECT_EQ(text, mesh::read_text(file))
        << "run this test with PALPATE_UPDATE=1 in the environment, and look at the draft";
    EXPECT_EQ(text.find('@'), std::string::npos);
}

TEST(Draft, OfAForceIsTheFileThatIsTried) { expect_draft(force(), "pull"); }
TEST(Draft, OfSpringsIsTheFileThatIsTried) { expect_draft(springs(), "ligament"); }
TEST(Draft, OfSwellingIsTheFileThatIsTried) { expect_draft(swelling(), "dry-spot"); }

TEST(Draft, NeedsANameThatIsFree) {
    EXPECT_EQ(message_of([] { draft_of(force(), "gravity"); }),
              "there is an effect 'gravity' already; give the file of the draft another name");
    for (const char* name : {"", "Pull", "pull 2"})
        EXPECT_NE(message_of([&] { draft_of(force(), name); }).find("small letters and hyphens"), std::string::npos);
}

TEST(Draft, IsOfWhatHasNoNameAlone) {
    EXPECT_EQ(message_of([] {
                  draft_of({"gravity", {}}, "pull");
              }),
              "'gravity' is in the catalogue: it needs no draft");
}

}  // namespace
}  // namespace palpate::pipeline
