// Tools in the report's view: as a set has them, with their forces.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/output/html/check/check_picture.h"
#include "pipeline/output/html/view_data.h"
#include "pipeline/output/html/view_tools.h"
#include "tests/pipeline/output/html/beam_run.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// Numbers of four bytes behind base64.
std::size_t packed_numbers(const json& array) {
    const std::string text = array["data"];
    return (text.size() / 4 * 3 - static_cast<std::size_t>(std::ranges::count(text, '='))) / 4;
}

/// Tools as the set has them, their measured forces, and what compare.json says of the model's.
TEST(ViewTools, HoldsToolsWithTheirForces) {
    const TemporaryFolder scratch;
    std::filesystem::copy(beam_run(), scratch / "run", std::filesystem::copy_options::recursive);
    const json before =
        view_data(scratch / "run", json::object(), json::parse(mesh::read_text(scratch / "run/compare/compare.json")),
                  nullptr, nullptr, {});
    const int probe = before["states"][0]["probe"];
    const double time = before["states"][0]["time"];
    EXPECT_TRUE(before["states"][0]["tools"].empty());
    EXPECT_TRUE(before["steps"][0]["forces_rms"].is_null());

    std::filesystem::create_directory(scratch / "set");
    mesh::write_surface(scratch / "set/rest.stl", mesh::make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2}));
    scratch.write("set/set.yaml",
                  "format: palpate-measurements/2\n"
                  "units: {length: mm, force: N, time: s, angle: rad}\n"
                  "rest_surface: rest.stl\n"
                  "supports: [{box: {min: [-1, -1, -1], max: [0.1, 21, 21]}}]\n"
                  "tools:\n"
                  "  - {name: ball, shape: {sphere: {radius: 4}}, at: [50, 10, 25], contact: frictionless}\n"
                  "  - {name: punch, shape: {flat: {radius: 3}}, at: [70, 10, 20], contact: bonded}\n"
                  "noise: {reaction: 0.01}\n");
    const std::string state = fmt::format("{},{},", probe, time);
    scratch.write("set/motions.csv", "probe,time,tool,x,y,z,rx,ry,rz\n" + state + "ball,0,0,-2,0,0,0\n" + state +
                                         "punch,,0,0,0,1.5707963267948966,0\n");
    scratch.write("set/reactions.csv", "probe,time,tool,fx,fy,fz\n" + state + "ball,,,-0.1\n");
    scratch.write("run/case.yaml", "measurements: '" + (scratch / "set").string() + "'\n");

    json compare = json::parse(mesh::read_text(scratch / "run/compare/compare.json"));
    compare["error"]["reactions"]["rms_n"] = 0.02;
    compare["tool_forces"] = json::array(
        {{{"probe", probe}, {"time", time}, {"tool", "ball"}, {"modelled_n", {0.0, 0.0, -0.08}}, {"error_n", 0.02}}});
    const json data = view_data(scratch / "run", json::object(), compare, nullptr, nullptr, {});
    const json& tools = data["states"][0]["tools"];
    ASSERT_EQ(tools.size(), 2U);
    EXPECT_EQ(tools[0], (json{{"name", "ball"},
                              {"at", {50.0, 10.0, 23.0}},
                              {"moved", {0.0, 0.0, -2.0}},
                              {"turned", {0.0, 0.0, 0.0}},
                              {"radius", 4.0},
                              {"axis", nullptr},
                              {"measured", {nullptr, nullptr, -0.1}}}));
    EXPECT_TRUE(tools[1]["at"].is_null()) << "free along x";
    EXPECT_EQ(tools[1]["moved"], json({nullptr, 0.0, 0.0}));
    EXPECT_NEAR(tools[1]["axis"][0].get<double>(), -1, 1e-12) << "turned from -z about y, to round-off";
    EXPECT_TRUE(tools[1]["measured"].is_null());
    EXPECT_EQ(data["steps"][0]["states"][0]["tool_forces"],
              json::array({{{"name", "ball"}, {"modelled", {0.0, 0.0, -0.08}}}}));
    EXPECT_EQ(data["steps"][0]["forces_rms"], 0.02);

    scratch.write("run/case.yaml", "measurements: '" + (scratch / "gone").string() + "'\n");
    EXPECT_TRUE(
        view_data(scratch / "run", json::object(), compare, nullptr, nullptr, {})["states"][0]["tools"].empty());
}

/// A mesh that is moved is held as it stands at rest, unless it has too many triangles; of a grip, what it holds of the
/// skin.
TEST(ViewTools, HoldsMeshesAndGrips) {
    const mesh::Surface body = mesh::make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2});
    const mesh::Surface punch = mesh::make_box({40, 5, 21}, {50, 15, 31}, {1, 1, 1});
    const mesh::Surface fine = mesh::make_box({60, 5, 21}, {70, 15, 31}, {50, 50, 50});
    identify::MeasurementSet set;
    set.tools = {{.name = "punch", .shape = mesh::SurfaceShape{punch}, .origin = {45, 10, 26}},
                 {.name = "fine", .shape = mesh::SurfaceShape{fine}},
                 {.name = "grip", .shape = mesh::GripShape{{mesh::BoxRegion{{89, -1, -1}, {101, 21, 21}}}}}};
    const json tools = tools_at_rest(set, body.vertices, body.triangles);
    ASSERT_EQ(tools.size(), 3U);
    EXPECT_EQ(tools[0]["origin"], json({45.0, 10.0, 26.0}));
    EXPECT_EQ(packed_numbers(tools[0]["surface"]["points"]), 3 * static_cast<std::size_t>(punch.vertices.rows()));
    EXPECT_EQ(packed_numbers(tools[0]["surface"]["triangles"]), 3 * static_cast<std::size_t>(punch.triangles.rows()));
    EXPECT_TRUE(tools[0]["patch"].is_null());
    EXPECT_TRUE(tools[1]["surface"].is_null());
    EXPECT_EQ(tools[1]["triangles_left_out"], fine.triangles.rows());
    EXPECT_EQ(tools[2]["triangles_left_out"], 0);
    // the last of ten slices: its end of 2 x 2 squares, and a ring of 4 x 2; two triangles each
    EXPECT_EQ(packed_numbers(tools[2]["patch"]), 3U * 2U * (4U + 8U));
}

/// The page of a check draws the tools of a set as a report does, of every kind.
TEST(ViewTools, AreInThePictureOfACheck) {
    const mesh::Surface body = mesh::make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2});
    identify::MeasurementSet set;
    set.rest_surface = body;
    set.tools = {{.name = "ball", .shape = mesh::SphereShape{4}, .origin = {50, 10, 24}},
                 {.name = "wedge", .shape = mesh::SurfaceShape{mesh::make_box({40, 5, 21}, {50, 15, 31}, {1, 1, 1})}},
                 {.name = "grip", .shape = mesh::GripShape{{mesh::BoxRegion{{89, -1, -1}, {101, 21, 21}}}}}};
    identify::LoadState state;
    state.probe = 1;
    state.motions = {{.tool = 1, .translation = {0, 0, -2}}, {.tool = 2, .translation = {identify::missing, 1, 0}}};
    set.states = {state};
    Subject subject;
    subject.surface = body;
    subject.set = set;
    const json data = check_picture(subject, nullptr);
    EXPECT_EQ(data["tools"], tools_at_rest(set, body.vertices, body.triangles));
    EXPECT_FALSE(data["tools"][1]["surface"].is_null());
    EXPECT_EQ(data["states"][0]["tools"], tools_in_state(set, {1, 0}));
    EXPECT_EQ(data["states"][0]["tools"].size(), 2U);
    EXPECT_EQ(data["surface"]["gripped"].size(), 8U + 9U) << "a ring of corners, and those of the end";
}

}  // namespace
}  // namespace palpate::pipeline
