// The settings of a case: one declaration each, and what comes of it.

#include "pipeline/case/settings/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "mesh/errors.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/case/settings/overrides.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/command_line/commands.h"
#include "tests/messages.h"
#include "tests/pipeline/output/html/beam_run.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;
using ::testing::HasSubstr;

/// The path of a population of one number.
std::string population() {
    static const TemporaryFolder scratch;
    return json(scratch
                    .write("population.json", R"({"format": "palpate-population/1", "numbers": [
                        {"name": "young", "of": "finite elements", "scale": "logarithmic",
                         "next": {"low": 0.2, "value": 0.3, "high": 0.45}}]})")
                    .string())
        .dump();
}

/// A value that is allowed and no default, as YAML has it.
std::string another_value(const CaseSetting& setting) {
    const ordered_json& schema = setting.schema;
    const std::string type = schema.value("type", "");
    if (setting.place() == "identify.prior") return population();
    if (type == "array") return schema["items"].contains("enum") ? "[torsion]" : "[gravity]";
    if (type == "boolean") return setting.value(Case{}) == json(true) ? "false" : "true";
    if (schema.contains("enum")) {
        const auto words = schema["enum"].get<std::vector<std::string>>();
        return *std::ranges::find_if(words, [&](auto& word) { return json(word) != setting.value(Case{}); });
    }
    return schema["maximum"].dump();
}

Case with(const CaseSetting& setting, const std::string& value) {
    CaseOverrides overrides;
    overrides.set(setting.place(), value);
    return overrides.on_defaults();
}

TEST(Settings, AreAtDifferentPlacesWithDifferentFlags) {
    std::set<std::string> places, flags;
    for (const CaseSetting& setting : settings()) {
        EXPECT_TRUE(places.insert(setting.place()).second) << setting.place();
        if (!setting.flag.empty()) {
            EXPECT_TRUE(flags.insert(setting.flag).second) << setting.flag;
        }
    }
}

TEST(Settings, AreReadBackFromTheCaseThatARunLeaves) {
    const TemporaryFolder scratch;
    for (const CaseSetting& setting : settings()) {
        Case changed = with(setting, another_value(setting));
        changed.name = "body";
        changed.mesh = scratch / "body.stl";
        changed.probing.held_out = std::min(changed.probing.held_out, changed.probing.probes - 1);
        if (changed.identify.search_low >= changed.identify.search_high)
            changed.identify.search_low = changed.identify.search_high / 2;
        const Case read = read_case(scratch.write("case.yaml", to_yaml(changed)));
        EXPECT_EQ(setting.value(read), setting.value(changed)) << setting.place();
        EXPECT_NE(setting.value(read), setting.value(Case{})) << setting.place();
    }
}

TEST(Settings, MakeTheirStageRunAgain) {
    for (const CaseSetting& setting : settings()) {
        if (setting.stage.empty()) continue;
        const Case changed = with(setting, another_value(setting));
        EXPECT_NE(settings_of_stage(changed, setting.stage), settings_of_stage(Case{}, setting.stage))
            << setting.place();
    }
}

/// A run's cache, end to end: the links' kind was forgotten there once.
TEST(Settings, OfLinksMakeTheSkeletonAnew) {
    const TemporaryFolder scratch;
    commands::RunOptions options = beam_options(scratch.path(), scratch / "run");
    commands::run(options, {});
    EXPECT_THAT(mesh::read_text(scratch / "run/identify/posterior.csv"), HasSubstr("shear"));
    options.overrides.set("skeleton.links", "burion2008");
    commands::run(options, {});
    EXPECT_THAT(mesh::read_text(scratch / "run/identify/posterior.csv"), Not(HasSubstr("shear")));
}

TEST(Settings, APriorIsReadWithItsPath) {
    const Case c = with(setting_at("identify.prior"), population());
    ASSERT_EQ(c.identify.priors.size(), 1u);
    EXPECT_EQ(c.identify.priors[0].parameter, "young");
    EXPECT_NEAR(c.identify.priors[0].mean, std::log(0.3), 1e-12);
    EXPECT_NEAR(c.identify.priors[0].sd, std::log(0.45 / 0.2) / (2 * 1.959964), 1e-12);
}

TEST(Settings, BeyondWhatIsAllowedAreRefusedByTheFlagsName) {
    EXPECT_TRUE(
        says(message_of([] { with(setting_at("skeleton.spheres"), "20001"); }), {"--spheres", "20001", "[0, 20000]"}));
    EXPECT_TRUE(
        says(message_of([] { with(setting_at("skeleton.links"), "fool"); }), {"--links", "fool", "full, burion2008"}));
    EXPECT_THAT(objection_to_value("probing.noise", "much"), HasSubstr("finite number"));
}

/// PALPATE_UPDATE=1 writes the schema.
TEST(Settings, HaveTheSchemaThatIsPublished) {
    const std::filesystem::path file = std::filesystem::path(schemas_folder) / "case.schema.json";
    ordered_json schema = ordered_json::parse(mesh::read_text(file));
    const ordered_json published = schema;
    for (const CaseSetting& setting : settings()) {
        ordered_json& holder = setting.section.empty() ? schema : schema["properties"][setting.section];
        holder["properties"][setting.key] = schema_of(setting);
    }
    if (std::getenv("PALPATE_UPDATE")) mesh::write_text(file, schema.dump(2) + "\n");
    EXPECT_TRUE(published == schema)
        << "run this test with PALPATE_UPDATE=1 in the environment, and look at the schema";
}

TEST(NewCase, ShowsEverySetting) {
    const TemporaryFolder scratch;
    commands::new_case({scratch / "body"}, {});
    const std::string text = mesh::read_text(scratch / "body/case.yaml");
    for (const CaseSetting& setting : settings()) EXPECT_THAT(text, HasSubstr(setting.key + ":")) << setting.place();
    EXPECT_THAT(text, Not(HasSubstr("{skeleton}")));
    EXPECT_THAT(text, HasSubstr(mesh::surface_extensions()));
}

}  // namespace
}  // namespace palpate::pipeline
