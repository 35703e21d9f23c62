// Bodies of several materials, probed: from a flag, from a case, and for another solver.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/body/reference_body.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/command_line/commands.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using identify::MeasurementSet;
using nlohmann::json;
using ::testing::HasSubstr;

/// A bar of 60 x 20 x 20 mm with a ball within, and a core in that.
class ProbeRegions : public ::testing::Test {
protected:
    void SetUp() override {
        mesh::write_surface(scratch_ / "bar.stl", mesh::make_box({0, 0, 0}, {60, 20, 20}, {6, 2, 2}));
        mesh::write_surface(scratch_ / "ball.stl", mesh::make_sphere({35, 10, 10}, 7, 2));
        mesh::write_surface(scratch_ / "core.stl", mesh::make_sphere({35, 10, 10}, 3, 2));
    }
    std::string ball(const std::string& numbers) const {
        return "ball:surface=" + (scratch_ / "ball.stl").string() + numbers;
    }
    std::string core(const std::string& numbers) const {
        return "core:surface=" + (scratch_ / "core.stl").string() + numbers;
    }
    commands::ProbeCommandOptions options(const std::vector<std::string>& regions,
                                          const BlindSetOptions& synthesis = {.hide = {"none"}}) const {
        commands::ProbeCommandOptions result{.input = scratch_ / "bar.stl",
                                             .output = scratch_ / "set",
                                             .overrides = {},
                                             .synthesis = synthesis,
                                             .regions = regions};
        result.overrides.set("volume.edge_length", 12);
        result.overrides.set("probing.probes", 3);
        result.overrides.set("probing.markers", 20);
        return result;
    }
    MeasurementSet probe(const commands::ProbeCommandOptions& how) const {
        commands::probe(how, {.json = false, .force = true, .threads = 1, .seed = {}});
        return identify::read_measurement_set(how.output);
    }
    std::string message(const commands::ProbeCommandOptions& how) const {
        return message_of<InvalidInput>([&] { commands::probe(how, {}); });
    }
    std::string message_of_regions(const std::vector<std::string>& regions) const { return message(options(regions)); }
    json truth() const { return json::parse(mesh::read_text(scratch_ / "set/truth.json")); }
    const TemporaryFolder scratch_;
};

TEST_F(ProbeRegions, ABlindSetTellsWhereTheyAreAndTruthHowStiff) {
    const MeasurementSet set = probe(options({ball(",young=2,poisson=0.4,density=1200"), core(",young=30")}));
    ASSERT_EQ(set.regions.size(), 2U);
    EXPECT_EQ(set.regions[0].name, "ball");
    EXPECT_FALSE(set.regions[0].young);
    EXPECT_EQ(set.regions[0].poisson.value(), 0.4);
    EXPECT_NEAR(set.regions[0].density.value(), 1.2e-9, 1e-20);
    EXPECT_FALSE(set.regions[1].young);
    const json regions = truth()["regions"];
    ASSERT_EQ(regions.size(), 2U);
    EXPECT_EQ(regions[0]["young_mpa"], 2.0);
    EXPECT_EQ(regions[0]["density_kg_m3"], 1200.0);
    EXPECT_EQ(regions[1]["name"], "core");
    EXPECT_EQ(regions[1]["young_mpa"], 30.0);
    EXPECT_EQ(regions[1]["poisson"], 0.45);

    // The body that is fitted follows both.
    const Reference reference = make_reference(set, 12);
    ASSERT_TRUE(reference.body) << reference.why_none;
    const auto& names = reference.body->parameters();
    ASSERT_EQ(names.size(), 4U);
    EXPECT_EQ(names[2].name, "young:ball");
    EXPECT_EQ(names[3].name, "young:core");
}

TEST_F(ProbeRegions, ASetThatTellsItsMaterialTellsTheirs) {
    const MeasurementSet set = probe(options({ball(",young=2")}, {}));
    ASSERT_EQ(set.regions.size(), 1U);
    EXPECT_EQ(set.regions[0].young.value(), 2.0);
}

TEST_F(ProbeRegions, AStiffOneStiffensTheBody) {
    auto soft = options({ball(",young=0.1")}, {.levels = 1}), stiff = options({ball(",young=20")}, {.levels = 1});
    const MeasurementSet as_the_rest = probe(soft), with_a_lump = probe(stiff);
    ASSERT_EQ(as_the_rest.states.size(), with_a_lump.states.size());
    // The same places are pressed, each as hard as moves it by as much.
    const auto compliance = [](const MeasurementSet& set) {
        double sum = 0;
        for (const identify::LoadState& state : set.states) {
            if (state.contacts.empty()) continue;
            double most = 0;
            for (const identify::Reading& reading : state.readings)
                most = std::max(most,
                                (reading.position - set.markers[static_cast<std::size_t>(reading.marker)].rest).norm());
            sum += most / state.contacts.front().force.norm();
        }
        return sum;
    };
    // An eighth of what a load at the tip bends is where the ball is, and sections there are stiffer by a seventh.
    EXPECT_LT(compliance(with_a_lump), 0.985 * compliance(as_the_rest));
}

TEST_F(ProbeRegions, OfACaseAreInTheDeckOfAnotherSolver) {
    scratch_.write("bar.yaml",
                   "format: palpate-case/1\nmesh: bar.stl\nregions:\n"
                   "  - {name: ball, surface: ball.stl, young: 2, poisson: 0.4, density: 1200}\n");
    auto how = options({});
    how.input = scratch_ / "bar.yaml";
    how.output = scratch_ / "deck";
    how.synthesis = {};
    how.to = "inp";
    commands::probe(how, {.json = false, .force = true, .threads = 1, .seed = {}});
    const std::string deck = mesh::read_text(scratch_ / "deck/body.inp");
    const double mu = 2 / 2.8;
    EXPECT_THAT(deck, HasSubstr("*ELSET, ELSET=EREGION1\n"));
    EXPECT_THAT(deck, HasSubstr(fmt::format("*MATERIAL, NAME=REGION1\n*HYPERELASTIC, NEO HOOKE\n{:.12g}, ", mu / 2)));
    EXPECT_THAT(deck, HasSubstr("*SOLID SECTION, ELSET=EREGION1, MATERIAL=REGION1\n"));
    EXPECT_THAT(deck, HasSubstr("*SOLID SECTION, ELSET=EBODY0, MATERIAL=BODY\n"));
}

TEST_F(ProbeRegions, ThatAreNotToldInFullAreRefused) {
    EXPECT_TRUE(says(message_of_regions({"ball"}), {"--region 'ball'", "names no region", "NAME:surface=FILE"}));
    EXPECT_TRUE(says(message_of_regions({"ball:young=1"}), {"has no surface", "NAME:surface=FILE"}));
    EXPECT_TRUE(says(message_of_regions({ball("")}), {"has no young"}));
    EXPECT_TRUE(says(message_of_regions({ball(",young=stiff")}), {"young = 'stiff'", "no number"}));
    EXPECT_TRUE(says(message_of_regions({ball(",young=-1")}), {"Young's modulus is -1"}));
    EXPECT_TRUE(says(message_of_regions({ball(",young=1,label=2")}), {"has two places", "NAME:label=N"}));
    EXPECT_TRUE(says(message_of_regions({"ball:label=1.5,young=1"}), {"label = '1.5'", "no whole number"}));
    EXPECT_TRUE(says(message_of_regions({"ball:label=1,young=1"}), {"bar.stl", "no labels"}));
    EXPECT_TRUE(says(message_of_regions({ball(",young=1,ratio=2")}), {"'ratio'", "which no region has"}));
    EXPECT_TRUE(says(message_of_regions({ball(",young=1,soft")}), {"'soft'", "not name=value"}));
    EXPECT_TRUE(says(message_of_regions({ball(",young=1"), ball(",young=2")}), {"'ball' is the name of two regions"}));
    scratch_.write("bar.yaml",
                   "format: palpate-case/1\nmesh: bar.stl\nregions:\n  - {name: a, surface: ball.stl, young: null}\n");
    auto how = options({});
    how.input = scratch_ / "bar.yaml";
    EXPECT_TRUE(says(message(how), {"bar.yaml", "region 'a' has no 'young'", "a simulation needs"}));
}

TEST_F(ProbeRegions, OfASetStandInItsOwnFile) {
    probe(options({}));
    scratch_.write("fit.yaml",
                   "format: palpate-case/1\nmeasurements: set\nregions:\n  - {name: a, surface: ball.stl, young: 1}\n");
    auto how = options({});
    how.input = scratch_ / "fit.yaml";
    EXPECT_TRUE(says(message(how), {"fit.yaml, line 3", "stand in its set.yaml"}));
    how.input = scratch_ / "set";
    how.regions = {ball(",young=1")};
    EXPECT_TRUE(says(message(how), {"--region", "states its regions itself"}));
}

TEST_F(ProbeRegions, ARunMeasuresThemAndTellsThemAgain) {
    scratch_.write(
        "bar.yaml",
        "format: palpate-case/1\nmesh: bar.stl\nvolume: {edge_length: 8}\nskeleton: {spheres: 6}\n"
        "probing: {probes: 3, markers: 20, held_out: 1}\nidentify: {particles: 40, parameters: uniform}\nregions:\n"
        "  - {name: ball, surface: ball.stl, young: 2, poisson: 0.4, density: 1200}\n");
    commands::run({.input = scratch_ / "bar.yaml", .output = scratch_ / "run", .overrides = {}}, {});
    mesh::MeshData data;
    const mesh::VolumeMesh body = mesh::read_vtu(scratch_ / "run/mesh/body.vtu", &data);
    ASSERT_EQ(data.cells.size(), 1U);
    const double enclosed = mesh::signed_volume(mesh::read_surface(scratch_ / "ball.stl"));
    EXPECT_NEAR(mesh::element_volumes(body).dot(data.cells[0].values.col(0)), enclosed, 0.01 * enclosed);
    const MeasurementSet set = identify::read_measurement_set(scratch_ / "run/measurements");
    ASSERT_EQ(set.regions.size(), 1U);
    EXPECT_EQ(set.regions[0].young.value(), 2.0);
    const json record = json::parse(mesh::read_text(scratch_ / "run/run.json"));
    EXPECT_THAT(record.dump(), HasSubstr("Region 'ball' is 20 times as stiff as the rest"));
    // What the run was told is a case again.
    const Case again = read_case(scratch_ / "run/case.yaml", {});
    ASSERT_EQ(again.regions.size(), 1U);
    EXPECT_EQ(again.regions[0].young.value(), 2.0);
    EXPECT_NEAR(again.regions[0].density.value(), 1.2e-9, 1e-20);
}

}  // namespace
}  // namespace palpate::pipeline
