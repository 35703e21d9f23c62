// The report page of a small run: what it says, and the numbers behind its view.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "identify/comparison/compare.h"
#include "identify/loading/readings.h"
#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/vtk/poly_data.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/analysis/link_uncertainty.h"
#include "pipeline/analysis/playback.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/output/csv/posterior.h"
#include "pipeline/output/html/report.h"
#include "pipeline/output/html/sections/error_section.h"
#include "pipeline/output/html/view_data.h"
#include "skeleton/model/io/model_io.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/messages.h"
#include "tests/pipeline/output/html/beam_run.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pointwise;

json data_of(const std::filesystem::path& run, std::size_t budget = 3'000'000) {
    return view_data(run, json::parse(mesh::read_text(run / "run.json")),
                     json::parse(mesh::read_text(run / "compare/compare.json")), nullptr, nullptr,
                     read_posterior(run / "identify/posterior.csv"), budget);
}

/// Bytes behind base64.
std::size_t bytes_of(const json& array) {
    const std::string text = array["data"];
    return text.size() / 4 * 3 - static_cast<std::size_t>(std::ranges::count(text, '='));
}

TEST(ReportPage, NeedsNoNetwork) {
    const std::string page = mesh::read_text(beam_run() / "report.html");
    EXPECT_EQ(page.find("http"), std::string::npos);
    EXPECT_EQ(page.find("src="), std::string::npos);
    EXPECT_LT(page.size(), 5'000'000U);
}

TEST(ReportPage, HoldsEverySectionThatTheRunHasAndNoOther) {
    const std::string page = mesh::read_text(beam_run() / "report.html");
    for (const char* section :
         {"id=\"view\"", "id=\"budget\"", "id=\"errors\"", "id=\"stiffness\"", "id=\"convergence\"", "id=\"files\"",
          "id=\"times\"", "id=\"settings\"", "id=\"run-data\""}) {
        EXPECT_THAT(page, HasSubstr(section));
    }
    EXPECT_THAT(page, AllOf(Not(HasSubstr("id=\"missing\"")), Not(HasSubstr("id=\"ladder\""))));
    EXPECT_THAT(page, HasSubstr("<a href=\"#stiffness\">Stiffness</a>"));
    EXPECT_THAT(page, HasSubstr("volume 40\u202f000 mm³")) << "figures of stages have their units";
}

/// The run's file and the page's chart of it, where one kind of load acts; none where kinds cannot be compared.
TEST(ReportPage, DrawsTheErrorOverTheLoad) {
    RunFiles files = read_run(beam_run());
    std::vector<double> told;
    for (const json& p : files.compare["probes"]) {
        const bool is_loaded = p["load"]["value"] > 0;
        EXPECT_EQ(p["load"]["by"], is_loaded ? "forces" : "nothing");
        EXPECT_EQ(p["load"]["unit"], is_loaded ? json("N") : json());
        told.push_back(p["load"]["value"]);
    }
    const identify::MeasurementSet set = identify::read_measurement_set(beam_run() / "measurements");
    std::vector<double> acting;
    for (const identify::LoadState& state : set.states) {
        acting.push_back(0);
        for (const mesh::Contact& contact : state.contacts) acting.back() += contact.force.norm();
    }
    EXPECT_THAT(told, Pointwise(DoubleNear(1e-6), acting));

    EXPECT_THAT(error_section(files), AllOf(HasSubstr("Error of each state over its load"), HasSubstr("forces [N]")));
    files.compare["probes"][0]["load"] = {{"by", "tools"}, {"value", 1.0}, {"unit", "mm"}};
    EXPECT_THAT(error_section(files), Not(HasSubstr("over its load")));
    files.compare["probes"][0]["load"] = nullptr;
    EXPECT_THAT(error_section(files), Not(HasSubstr("over its load")));
}

TEST(ReportPage, OfNoRunSaysSo) {
    const TemporaryFolder scratch;
    EXPECT_THROW(write_report(scratch.path(), scratch / "report.html"), InvalidInput);
}

/// A quarter, half, as many and twice as many spheres as the run has; gone again where they are not asked for.
TEST(SphereCurve, IsMeasuredWhereItIsAskedFor) {
    const TemporaryFolder scratch;
    std::filesystem::copy(beam_run(), scratch / "run", std::filesystem::copy_options::recursive);
    commands::RunOptions options = beam_options(beam_run().parent_path(), scratch / "run");
    options.overrides.set("skeleton.sphere_curve", "true");
    commands::run(options, {});
    const json curve = json::parse(mesh::read_text(scratch / "run/skeleton/sphere_curve.json"));
    std::map<int, bool> steps;
    for (const json& step : curve["rungs"]) steps[step["spheres"]] = step["own"];
    EXPECT_EQ(steps, (std::map<int, bool>{{1, false}, {3, false}, {6, true}, {12, false}}));
    EXPECT_THAT(mesh::read_text(scratch / "run/report.html"), HasSubstr("id=\"spheres\""));

    options.overrides.set("skeleton.sphere_curve", "false");
    commands::run(options, {});
    EXPECT_FALSE(std::filesystem::exists(scratch / "run/skeleton/sphere_curve.json"));
    EXPECT_FALSE(json::parse(mesh::read_text(scratch / "run/run.json"))["stages"].contains("sphere_curve"));
    EXPECT_THAT(mesh::read_text(scratch / "run/report.html"),
                AllOf(Not(HasSubstr("id=\"spheres\"")), HasSubstr("--sphere-curve")));
}

TEST(ViewData, HoldsTheBodyAndEachAnswer) {
    const json data = data_of(beam_run());
    const mesh::PolyData skin = mesh::read_poly_data(beam_run() / "compare/skin_000.vtp");
    const mesh::PolyData spheres = mesh::read_poly_data(beam_run() / "compare/skeleton_000.vtp");
    const auto vertices = static_cast<std::size_t>(skin.points.rows()),
               balls = static_cast<std::size_t>(spheres.points.rows());
    EXPECT_EQ(bytes_of(data["surface"]["points"]), 12 * vertices);
    EXPECT_EQ(bytes_of(data["spheres"]["radii"]), 4 * balls);
    EXPECT_EQ(bytes_of(data["links"]), 8 * static_cast<std::size_t>(spheres.lines.rows()));
    ASSERT_EQ(data["steps"].size(), 1U);
    EXPECT_EQ(data["steps"][0]["states"].size(), data["states"].size());
    for (const json& state : data["steps"][0]["states"]) {
        EXPECT_EQ(bytes_of(state["skin"]), 6 * vertices);
        EXPECT_EQ(bytes_of(state["spheres"]), 6 * balls);
        EXPECT_EQ(bytes_of(state["markers"]["error"]), 12 * state["markers"]["id"].size());
    }
    const auto held = std::ranges::count_if(data["states"], [](const json& s) { return s["held_out"].get<bool>(); });
    EXPECT_GT(held, 0);
    EXPECT_LT(static_cast<std::size_t>(held), data["states"].size());
    for (const json& state : data["states"])
        EXPECT_FALSE(state["measured"].is_null()) << "simulated: the field is known";
}

/// What links are coloured by, in words and units for people.
TEST(ViewData, NamesStiffnessesInWords) {
    std::vector<std::string> names;
    const json data = data_of(beam_run());
    for (const json& quantity : data["steps"][0]["quantities"]) {
        names.push_back(quantity["name"]);
        const bool is_relative = names.back().ends_with("relative sd"),
                   is_of_angles = names.back().starts_with("bending") || names.back().starts_with("torsion");
        EXPECT_EQ(quantity["relative"], is_relative);
        EXPECT_EQ(quantity["unit"] == "N·mm/rad", is_of_angles && !is_relative) << names.back();
    }
    EXPECT_THAT(names, ::testing::IsSupersetOf({"elongation stiffness", "bending stiffness, 2nd plane",
                                                "shear stiffness, 2nd plane", "bending stiffness, relative sd"}));
}

/// Where not all states fit, those with the largest errors are kept.
TEST(ViewData, KeepsTheWorstStatesWithinItsBudget) {
    const json whole = data_of(beam_run()), small = data_of(beam_run(), 1);
    ASSERT_EQ(small["states"].size(), 1U);
    EXPECT_EQ(small["left_out"], whole["states"].size() - 1);
    const json compare = json::parse(mesh::read_text(beam_run() / "compare/compare.json"));
    json worst = compare["probes"][0];
    for (const json& probe : compare["probes"]) {
        if (probe["rms_mm"] > worst["rms_mm"]) worst = probe;
    }
    EXPECT_EQ(small["states"][0]["probe"], worst["probe"]);
}

/// What is played is written for a spreadsheet, too: where a marker is, and how far that can be relied on.
TEST(Simulate, WritesPositionsWithTheirIntervals) {
    const TemporaryFolder scratch;
    const std::filesystem::path model = beam_run() / "identify/model.json";
    mesh::write_text(scratch / "probes.csv", "probe,time,x,y,z,fx,fy,fz,radius\n1,0,100,10,20,0,0,-0.001,4\n");
    mesh::write_text(scratch / "markers.csv", "marker,x,y,z\ntip,100,10,20\nfoot,0,10,10\n");
    const auto rows_of = [&](const char* name) {
        std::istringstream lines(mesh::read_text(scratch / name / "positions.csv"));
        std::vector<std::string> rows;
        for (std::string line; std::getline(lines, line);)
            if (!line.starts_with("#")) rows.push_back(line);
        return rows;
    };
    commands::simulate({.model = model,
                        .probes = scratch / "probes.csv",
                        .output = scratch / "played",
                        .markers = scratch / "markers.csv"},
                       {});
    const std::vector<std::string> pressed = rows_of("played");
    ASSERT_EQ(pressed.size(), 3U);
    EXPECT_EQ(pressed[0], "probe,time,marker,x,y,z,ux,uy,uz,sd,within_95");
    EXPECT_THAT(pressed[1], AllOf(::testing::StartsWith("1,0,tip,"), Not(::testing::EndsWith(","))));
    const auto cell = [](const std::string& row, int column) {
        std::istringstream cells(row);
        std::string one;
        for (int c = 0; c <= column; ++c) std::getline(cells, one, ',');
        return std::stod(one);
    };
    EXPECT_LT(cell(pressed[1], 8), 0) << "pressed down";
    EXPECT_NEAR(cell(pressed[1], 5), 20 + cell(pressed[1], 8), 1e-4);
    EXPECT_NEAR(cell(pressed[2], 8), 0, 1e-3 * std::abs(cell(pressed[1], 8))) << "it is held";
    EXPECT_NEAR(cell(pressed[1], 10), 1.96 * cell(pressed[1], 9), 1e-3 * cell(pressed[1], 10));

    // its own weight besides
    commands::simulate({.model = model,
                        .probes = scratch / "probes.csv",
                        .output = scratch / "hanging",
                        .add = {"gravity:gz=-9810"},
                        .markers = scratch / "markers.csv"},
                       {});
    EXPECT_LT(cell(rows_of("hanging")[1], 8), cell(pressed[1], 8));
    EXPECT_THROW(commands::simulate({.model = model,
                                     .probes = scratch / "probes.csv",
                                     .output = scratch / "none",
                                     .add = {"misalignment:tx=1"}},
                                    {}),
                 InvalidInput);
    EXPECT_THROW(commands::simulate({.model = model,
                                     .probes = scratch / "probes.csv",
                                     .output = scratch / "none",
                                     .add = {"inclusion:ratio=8"}},
                                    {}),
                 InvalidInput);
}

/// What is missing is said as it is written.
TEST(Simulate, RefusesAnEffectWithoutNumbers) {
    const TemporaryFolder scratch;
    mesh::write_text(scratch / "probes.csv", "probe,time,x,y,z,fx,fy,fz,radius\n1,0,100,10,20,0,0,-0.001,4\n");
    const auto message = [&](const char* effect) {
        return message_of<InvalidInput>([&] {
            commands::simulate({.model = beam_run() / "identify/model.json",
                                .probes = scratch / "probes.csv",
                                .output = scratch / "none",
                                .add = {effect}},
                               {});
        });
    };
    EXPECT_THAT(message("gravity"), HasSubstr("give them, e.g. gravity:gz=-9810"));
    EXPECT_THAT(message("stiffening"), HasSubstr("e.g. stiffening:c2=VALUE"));
}

/// The pictures show what the errors were told of.
TEST(Play, EndsWhereTheComparisonDoes) {
    const skeleton::Model model = skeleton::read_model(beam_run() / "identify/model.json");
    const identify::MeasurementSet set = identify::read_measurement_set(beam_run() / "measurements");
    const identify::Comparison comparison = identify::compare(model, set);
    const std::vector<identify::ReducedLoadEquilibrium> played = play(model, set);
    ASSERT_EQ(played.size(), set.states.size());
    for (const identify::StateReadings& read : identify::collect_readings(model, set)) {
        const identify::ReducedLoadEquilibrium& answer = played[static_cast<std::size_t>(read.state)];
        const Points seen = skeleton::observed(model, answer.equilibrium, answer.load, read.points);
        const Points told = comparison.predicted[static_cast<std::size_t>(read.state)](read.rows, Eigen::all);
        EXPECT_NEAR((seen - told).norm(), 0, 1e-9) << "to what two solves of one equilibrium differ by";
    }
}

identify::PosteriorRow stiffness_row(const std::string& name, int link, double mean, double sd) {
    return {name, link, "N/mm", mean, sd, mean - sd, mean, mean + sd, 1, 1, false};
}

TEST(LinkUncertainty, FollowsTheScopeOfEachRow) {
    const Eigen::VectorXd zones = (Eigen::VectorXd(3) << 0, 1, 1).finished();
    const auto of = [&](const std::vector<identify::PosteriorRow>& rows) { return link_uncertainty(rows, zones); };
    EXPECT_EQ(of({stiffness_row("elongation", -1, 2, 1)})[0].values.col(0), Eigen::Vector3d(0.5, 0.5, 0.5));
    const auto by_zone = of({stiffness_row("flexion:zone0", -1, 2, 1), stiffness_row("flexion:zone1", -1, 4, 1)});
    EXPECT_EQ(by_zone[0].name, "flexion sd/mean [-]");
    EXPECT_EQ(by_zone[0].values.col(0), Eigen::Vector3d(0.5, 0.25, 0.25));
    const auto by_link = of({stiffness_row("torsion:link2", 2, 10, 1), stiffness_row("volume:sphere1", -1, 1, 1)});
    ASSERT_EQ(by_link.size(), 1U);  // a sphere's is none of a link's
    EXPECT_TRUE(std::isnan(by_link[0].values(0, 0)));
    EXPECT_EQ(by_link[0].values(2, 0), 0.1);
}

}  // namespace
}  // namespace palpate::pipeline
