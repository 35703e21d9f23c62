// The main job on a small beam: what it leaves behind, and what it does not do twice.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/run/expectation.h"
#include "tests/messages.h"
#include "tests/pipeline/output/html/beam_run.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

commands::RunOptions small_run(const TemporaryFolder& scratch) {
    commands::RunOptions options = beam_options(scratch.path(), scratch / "run");
    options.overrides.set("volume.edge_length", 12);
    options.overrides.set("skeleton.spheres", 8);
    options.overrides.set("probing.probes", 10);
    return options;
}

json record(const TemporaryFolder& scratch) { return json::parse(mesh::read_text(scratch / "run/run.json"))["stages"]; }

TEST(Run, LeavesTheFilesThatItPromises) {
    const TemporaryFolder scratch;
    const commands::Outcome outcome = commands::run(small_run(scratch), {});
    EXPECT_EQ(outcome.code, commands::done);
    for (const char* file :
         {"case.yaml", "run.json", "mesh/body.vtu", "skeleton/model.json", "skeleton/skeleton.vtp",
          "skeleton/medial_axis.vtp", "reference/reference.pvd", "measurements/set.yaml", "identify/model.json",
          "identify/posterior.csv", "identify/history.pvd", "compare/compare.json", "compare/markers.pvd",
          "compare/skin.pvd", "report.html", "view.py"}) {
        EXPECT_TRUE(std::filesystem::exists(scratch / "run" / file)) << file;
    }
    // What eight spheres in a slender beam leave of finite elements' motion: 2.4 %.
    EXPECT_LT(outcome.json["compare"]["error"]["relative"].get<double>(), 0.03);
    EXPECT_TRUE(outcome.json["compare"].contains("held_out"));
}

/// A simulation's fields are measurements too: without markers, the surface's vertices are read from them.
TEST(Run, TakesASetOfFieldsWithoutMarkers) {
    const TemporaryFolder scratch;
    commands::run(small_run(scratch), {});
    const auto set = scratch / "run/measurements";
    std::filesystem::remove(set / "markers.csv");
    std::filesystem::remove(set / "positions.csv");
    const commands::Outcome outcome = commands::compare({.model = scratch / "run/identify/model.json",
                                                         .set = set,
                                                         .output = scratch / "compared",
                                                         .tolerance = {},
                                                         .no_reference = true},
                                                        {});
    EXPECT_EQ(outcome.code, commands::done);
    EXPECT_LT(outcome.json["error"]["relative"].get<double>(), 0.03);  // as of markers
    EXPECT_TRUE(std::filesystem::exists(scratch / "compared/markers.pvd"));
}

TEST(Run, RepeatsNothingWhoseInputsAreUnchanged) {
    const TemporaryFolder scratch;
    commands::RunOptions options = small_run(scratch);
    commands::run(options, {});
    const json before = record(scratch);
    commands::run(options, {});
    EXPECT_EQ(before, record(scratch));

    // Other particles: identification and what follows from it are done again, and nothing else.
    options.overrides.set("identify.particles", 50);
    commands::run(options, {});
    const json after = record(scratch);
    for (const char* same : {"mesh", "skeleton", "measurements"}) EXPECT_EQ(before[same], after[same]) << same;
    for (const char* other : {"identify", "compare"}) EXPECT_NE(before[other]["key"], after[other]["key"]) << other;
}

/// Elements end at the borders of supports.
TEST(Run, OtherSupportsMakeAnotherMesh) {
    const TemporaryFolder scratch;
    const commands::RunOptions options = small_run(scratch);
    commands::run(options, {});
    const json before = record(scratch);
    std::string settings = mesh::read_text(scratch / "run/case.yaml");
    ASSERT_EQ(settings.find("\nsupports:"), std::string::npos) << "a bare mesh has none";
    settings += "\nsupports:\n  - box: {min: [-1, -1, -1], max: [8, 21, 21]}\n";
    mesh::write_text(scratch / "again.yaml", settings);
    commands::run({.input = scratch / "again.yaml", .output = scratch / "run", .overrides = {}}, {});
    EXPECT_NE(before["mesh"]["key"], record(scratch)["mesh"]["key"]);
    EXPECT_NE(before["mesh"]["figures"], record(scratch)["mesh"]["figures"]);
}

TEST(Run, SettingsReadBackGiveTheSameRun) {
    const TemporaryFolder scratch;
    commands::run(small_run(scratch), {});
    const json before = record(scratch);
    std::filesystem::copy(scratch / "run/case.yaml", scratch / "again.yaml");
    commands::run({.input = scratch / "again.yaml", .output = scratch / "run", .overrides = {}}, {});
    EXPECT_EQ(before, record(scratch));
}

TEST(Run, ThreadCountChangesNoNumber) {
    const TemporaryFolder scratch;
    commands::RunOptions options = small_run(scratch);
    commands::run(options, {.json = false, .force = false, .threads = 1, .seed = {}});
    const std::string one = mesh::read_text(scratch / "run/identify/posterior.csv");
    options.output = scratch / "other";
    commands::run(options, {.json = false, .force = false, .threads = 3, .seed = {}});
    EXPECT_EQ(one, mesh::read_text(scratch / "other/identify/posterior.csv"));
}

TEST(Run, TellsExpectationsThatAreNotMet) {
    const TemporaryFolder scratch;
    small_run(scratch);
    const auto file =
        scratch.write("case.yaml",
                      "format: palpate-case/1\nmesh: beam.stl\nvolume: {edge_length: 12}\nskeleton: {spheres: 8}\n"
                      "probing: {probes: 5, held_out: 1}\nidentify: {parameters: uniform, particles: 40}\n"
                      "expect: {relative_at_most: 0.000001}\n");
    const commands::Outcome outcome = commands::run({.input = file, .output = scratch / "run", .overrides = {}}, {});
    EXPECT_EQ(outcome.code, commands::not_met);
    EXPECT_EQ(outcome.json["expectations_not_met"].size(), 1U);
}

TEST(RunMessages, RefusesADraftThatCannotBeNamedSoBeforeAnythingIsRead) {
    EXPECT_TRUE(says(message_of<InvalidInput>([] {
                         commands::improve(
                             {.model = "m.json", .set = "set", .output = {}, .residual = true, .draft = "gravity.cpp"},
                             {});
                     }),
                     {"gravity", "another name"}));
}

TEST(RunMessages, SeveralOfAKindNeedTheirPlaces) {
    const auto message = [](const std::vector<std::string>& add) {
        return message_of<std::exception>(
            [&] { commands::improve({.model = "m.json", .set = "set", .output = {}, .add = add}, {}); });
    };
    EXPECT_TRUE(says(message({"inclusion", "inclusion:cx=1"}), {"inclusion", "several times", "cx", "--auto"}));
    EXPECT_FALSE(says(message({"inclusion:cx=30", "inclusion:cx=1"}), {"several times"}));
}

TEST(RunMessages, TellHowManyExpectationsAreNotMet) {
    Expectation expect;
    expect.verdict = "missing-effect";
    expect.explanation = {"misalignment", "gravity"};
    expect.rms_at_most_mm = 1;
    RunResults results{.compare = {{"error", {{"rms_mm", 3.0}, {"relative", 0.1}}}}};
    EXPECT_THAT(broken_expectations(expect, results), ::testing::SizeIs(3));
    results.diagnosis = {{"verdict", "missing-effect"}, {"explanation", {"gravity", "misalignment"}}};
    results.ladder = {{"steps", {{{"rms_mm", 3.0}}, {{"rms_mm", 0.9}}}}};
    EXPECT_THAT(broken_expectations(expect, results), ::testing::IsEmpty());
}

TEST(RunMessages, AnUnknownEffectIsToldWithItsNeighbour) {
    const auto says_gravity = [](const auto& command) {
        return says(message_of<InvalidInput>(command), {"gravty", "gravity"});
    };
    EXPECT_TRUE(says_gravity([] { commands::effects({"gravty"}, {}); }));
    EXPECT_TRUE(says_gravity(
        [] { commands::improve({.model = "m.json", .set = "set", .output = {}, .add = {"gravty"}}, {}); }));
    EXPECT_TRUE(says_gravity(
        [] { commands::diagnose({.model = "m.json", .set = "set", .output = {}, .without = {"gravty"}}, {}); }));
    const TemporaryFolder scratch;
    const auto file =
        scratch.write("case.yaml", "format: palpate-case/1\nmesh: a.stl\ndiagnose: {without: [gravty]}\n");
    EXPECT_TRUE(says_gravity([&] { read_case(file); }));
}

TEST(RunMessages, AVerdictThatThereIsNotIsRefused) {
    const TemporaryFolder scratch;
    const auto file = scratch.write("case.yaml", "format: palpate-case/1\nmesh: a.stl\nexpect: {verdict: fine}\n");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read_case(file); }), {"line 3", "verdict", "unexplained"}));
}

}  // namespace
}  // namespace palpate::pipeline
