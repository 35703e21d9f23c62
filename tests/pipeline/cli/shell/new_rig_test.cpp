// Sets of rigs: what there is to start from, what `check` and `info` tell of it, and what `run` makes of it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/cli/shell/new_rig.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/output/text/describe/describe.h"
#include "samples/lattice.h"
#include "skeleton/model/io/model_io.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct RigSets : ::testing::Test {
    std::filesystem::path made(const std::string& rig) {
        commands::new_case({.folder = scratch / rig, .rig = rig}, {});
        return scratch / rig;
    }
    static commands::Outcome checked(const std::filesystem::path& set) {
        return commands::check({.input = set, .overrides = {}}, {});
    }
    TemporaryFolder scratch;
};

TEST_F(RigSets, OfEveryKindAreAccepted) {
    ASSERT_EQ(commands::rig_names().size(), 4U);
    for (const std::string& rig : commands::rig_names()) {
        const commands::Outcome outcome = checked(made(rig));
        EXPECT_EQ(outcome.code, commands::done) << rig;
        EXPECT_THAT(outcome.text,
                    AllOf(HasSubstr("The surface is sound"), Not(HasSubstr("warning")), Not(HasSubstr("bowstring"))))
            << rig;
        EXPECT_TRUE(outcome.json["faults"].empty()) << rig;
        // what is read back says the same
        const identify::MeasurementSet set = identify::read_measurement_set(scratch / rig);
        identify::write_measurement_set(scratch / "copy", set);
        EXPECT_EQ(checked(scratch / "copy").json["set"], outcome.json["set"]) << rig;
    }
}

TEST_F(RigSets, AreToldByCheckAndInfo) {
    const commands::Outcome pressed = checked(made("indenter"));
    EXPECT_THAT(pressed.text,
                AllOf(HasSubstr("4 states (4 loaded)"), HasSubstr("Tool 'indenter': a sphere of radius 5 mm"),
                      HasSubstr("frictionless; 4 motions; 4 readings of its reaction, of fz"),
                      Not(HasSubstr("Cannot be fitted yet")), HasSubstr("palpate run")));
    EXPECT_EQ(pressed.json["set"]["tools"][0]["reads"], nlohmann::json({"fz"}));
    EXPECT_TRUE(pressed.json["set"]["tells_a_force"]);

    const commands::Outcome pulled = checked(made("tensile"));
    EXPECT_THAT(pulled.text, AllOf(HasSubstr("a grip of 1 region"), HasSubstr("Tool 'clamp' grips"),
                                   HasSubstr("taken as positions, from rest")));

    const Description blown = describe(made("pneumatic"));
    EXPECT_THAT(blown.lines,
                ::testing::Contains(AllOf(HasSubstr("actuator 'chamber': pressure in a cavity of 2640 mm^3"),
                                          HasSubstr("4 actuations from 0 to 0.02 MPa"))));
    const Description bent = describe(made("tendon"));
    EXPECT_THAT(bent.lines, ::testing::Contains(AllOf(HasSubstr("'upper': a tendon through 5 points, 95 mm long"),
                                                      HasSubstr("from 0 to 0.5 N"))));
    for (const auto& [table, kind] : {std::pair("indenter/motions.csv", "motions of tools"),
                                      std::pair("indenter/reactions.csv", "measured reactions of tools"),
                                      std::pair("tendon/actuations.csv", "what actuators were set to"),
                                      std::pair("tensile/displacements.csv", "measured displacements of markers")})
        EXPECT_EQ(describe(scratch / table).kind, kind);
}

TEST_F(RigSets, AnEmptySetIsThereToBeFilledIn) {
    const std::filesystem::path set = scratch / "mine";
    EXPECT_THAT(
        commands::new_case({.folder = set, .measurements = true}, {}).text,
        AllOf(HasSubstr("an empty measurement set"), HasSubstr("Next: fill in the three tables, then palpate check")));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { checked(set); }), {"probes.csv", "no rows", "Add a row"}));

    // as its comments show
    for (const char* table : {"probes.csv", "markers.csv", "positions.csv"}) {
        std::string text = mesh::read_text(set / table);
        for (const char* row : {"# 0,", "# 1,", "# tip_top", "# middle"})
            for (std::size_t at = text.find(row); at != std::string::npos; at = text.find(row)) text.erase(at, 2);
        mesh::write_text(set / table, text);
    }
    EXPECT_THAT(checked(set).text,
                AllOf(HasSubstr("2 states (1 loaded), 2 markers, 2 readings"), HasSubstr("The surface is sound")));
    const identify::MeasurementSet read = identify::read_measurement_set(set);
    EXPECT_EQ(read.markers.front().name, "tip_top");
    EXPECT_EQ(read.states.back().readings.front().marker, 0);
    identify::write_measurement_set(scratch / "copy", read);
    EXPECT_EQ(identify::read_measurement_set(scratch / "copy").markers.front().name, "tip_top");

    mesh::write_text(set / "positions.csv", "probe;time;Marker;X [mm];y;z\r\n1;0;tip_tpo;99,2;10;14,1\r\n");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { checked(set); }),
                     {"positions.csv, line 2", "tip_tpo", "did you mean 'tip_top'?"}));
    mesh::write_text(set / "positions.csv", "probe;time;Marker;X [m];y;z\r\n1;0;tip_top;99,2;nan;14,1\r\n");
    EXPECT_TRUE(
        says(message_of<InvalidInput>([&] { checked(set); }), {"positions.csv, column x", "[m]", "set.yaml says mm"}));
    mesh::write_text(set / "positions.csv", "probe;time;Marker;X [mm];y;z\r\n1;0;tip_top;99,2;nan;14,1\r\n");
    const identify::Reading reading = identify::read_measurement_set(set).states.back().readings.front();
    EXPECT_EQ(reading.position.x(), 99.2);
    EXPECT_TRUE(std::isnan(reading.position.y()));
}

TEST_F(RigSets, WithoutAForceTellRatiosOnly) {
    const auto set = made("tensile");
    std::filesystem::remove(set / "reactions.csv");
    EXPECT_THAT(checked(set).text, HasSubstr("No force is measured: stiffness is identified up to a common factor"));
}

TEST_F(RigSets, GripsThatHoldNothingAreWarnedOf) {
    const auto set = made("tensile");
    std::string yaml = mesh::read_text(set / "set.yaml");
    const std::string box = "{min: [50, -1, -1], max: [61, 11, 5]}";
    yaml.replace(yaml.find(box), box.size(), "{min: [50.5, 3, 1], max: [55, 4, 3]}");
    mesh::write_text(set / "set.yaml", yaml);
    EXPECT_THAT(checked(set).text, HasSubstr("Tool 'clamp' grips nothing of the surface"));
}

TEST_F(RigSets, AreNotFittedWithoutAllThatTheySay) {
    const auto set = made("tensile");
    std::string yaml = mesh::read_text(set / "set.yaml") + "correlated: {position: 3}\n";
    const std::string noise = ", position: 0.01}";
    yaml.replace(yaml.find(noise), noise.size(), "}");
    mesh::write_text(set / "set.yaml", yaml);
    const auto refusal = AllOf(HasSubstr("set 'tensile'"), HasSubstr("cannot be fitted yet"),
                               HasSubstr("'correlated.position'"), HasSubstr("noise.position"));
    EXPECT_THAT(message_of<InvalidInput>(
                    [&] { commands::run({.input = set, .output = scratch / "run", .overrides = {}}, {}); }),
                refusal);
    EXPECT_FALSE(std::filesystem::exists(scratch / "run/mesh"));

    const auto model = scratch / "model.json";
    skeleton::write_model(model, samples::make_lattice("bar", {3, 2, 1}, 1));
    const auto out = scratch / "out";
    EXPECT_THAT(message_of<InvalidInput>([&] { commands::identify({model, set, out, {}}, {}); }), refusal);
    EXPECT_THAT(message_of<InvalidInput>(
                    [&] { commands::compare({.model = model, .set = set, .output = out, .tolerance = {}}, {}); }),
                refusal);
    EXPECT_THAT(message_of<InvalidInput>([&] { commands::diagnose({.model = model, .set = set, .output = out}, {}); }),
                refusal);
    EXPECT_FALSE(std::filesystem::exists(out));
}

/// A tensile test tells Young's modulus by the force that its clamp feels.
TEST_F(RigSets, ATensileTestRuns) {
    const commands::Outcome outcome =
        commands::run({.input = made("tensile"), .output = scratch / "run", .overrides = {}}, {});
    EXPECT_EQ(outcome.code, commands::done);
    EXPECT_EQ(outcome.json["diagnosis"]["verdict"], "adequate");
    // Its rounded numbers are those of a strip of 0.5 MPa; play and compliance of 2 % each blur it by some 3 %.
    EXPECT_NEAR(outcome.json["compare"]["baseline"]["young_mpa"].get<double>(), 0.5, 0.03);
    EXPECT_LT(outcome.json["compare"]["error"]["relative"].get<double>(), 0.11);  // a coarse skeleton's 9.5 %
    for (const char* file : {"identify/posterior.csv", "compare/markers.pvd", "improve/ladder.json", "report.html"})
        EXPECT_TRUE(std::filesystem::exists(scratch / "run" / file)) << file;
}

TEST_F(RigSets, DoNotReplaceAFolder) {
    made("tendon");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { made("tendon"); }), {"exists already"}));
}

}  // namespace
}  // namespace palpate::pipeline
