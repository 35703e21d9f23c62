// What of a model's effects is drawn in the body: on pages, and in a file for ParaView.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "mesh/formats/vtk/poly_data.h"
#include "pipeline/output/findings.h"
#include "pipeline/output/vtk/findings_file.h"
#include "samples/lattice.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// What was found is drawn where it is, without what the readings do not determine of it.
TEST(FindingsJson, TellsWhatCanBeDrawn) {
    const json diagnosis = {{"ranking",
                             {{{"effect", "gravity"},
                               {"sentence", "Gravity is missing: 9.2 m/s^2 along -z."},
                               {"parameters",
                                {{"gx", {{"value", 4700.0}, {"sd", 4200.0}}},
                                 {"gy", {{"value", -90.0}, {"sd", 320.0}}},
                                 {"gz", {{"value", -9200.0}, {"sd", 460.0}}}}}}}}};
    const json found = findings_json(
        {{"gravity", {{"gx", 4700, "mm/s^2"}, {"gy", -90, "mm/s^2"}, {"gz", -9200, "mm/s^2"}}},
         {"inclusion", {{"cx", 1, "mm"}, {"cy", 2, "mm"}, {"cz", 3, "mm"}, {"radius", 4, "mm"}, {"ratio", 8, "1"}}},
         {"contact",
          {{"nx", 0, "1"}, {"ny", 0, "1"}, {"nz", 1, "1"}, {"offset", -5, "mm"}, {"stiffness", 1, "N/mm^3"}}},
         {"local-force",
          {{"cx", 1, "mm"},
           {"cy", 0, "mm"},
           {"cz", 0, "mm"},
           {"radius", 2, "mm"},
           {"fx", 0, "N"},
           {"fy", 3, "N"},
           {"fz", 0, "N"}}},
         {"stiffening", {{"c2", 0.5, "1"}, {"c3", 0, "1"}}}},
        diagnosis);
    ASSERT_EQ(found.size(), 5U);
    EXPECT_EQ(found[0]["kind"], "arrow");
    EXPECT_EQ(found[0]["vector"], json({0.0, -90.0, -9200.0}));
    EXPECT_EQ(found[0]["undetermined"], json::array({{{"axis", {1, 0, 0}}, {"value", 4700.0}, {"sd", 4200.0}}}));
    EXPECT_EQ(found[0]["words"], "Gravity is missing: 9.2 m/s^2 along -z.");
    EXPECT_EQ(found[1]["kind"], "ball");
    EXPECT_EQ(found[1]["center"], json({1.0, 2.0, 3.0}));
    EXPECT_EQ(found[1]["radius"], 4.0);
    EXPECT_EQ(found[1]["ratio"], 8.0);
    EXPECT_EQ(found[2]["kind"], "plane");
    EXPECT_EQ(found[2]["offset"], -5.0);
    EXPECT_THAT(found[1]["words"].get<std::string>(), HasSubstr("hard"));
    EXPECT_EQ(found[3]["kind"], "ball");
    EXPECT_EQ(found[3]["vector"], json({0.0, 3.0, 0.0}));
    EXPECT_FALSE(found[3].contains("ratio")) << "a force is neither softer nor stiffer";
    EXPECT_EQ(found[4]["kind"], "words");
    EXPECT_EQ(found[4]["effect"], "stiffening");
}

TEST(FindingsJson, TwoInclusionsHaveTheirOwnWords) {
    const auto ball = [](double x) {
        return skeleton::EffectRecord{
            "inclusion", {{"cx", x, "mm"}, {"cy", 0, "mm"}, {"cz", 0, "mm"}, {"radius", 4, "mm"}, {"ratio", 8, "1"}}};
    };
    const auto row = [](const std::string& sentence) {
        return json{{"effect", "inclusion"}, {"sentence", sentence}, {"parameters", json::object()}};
    };
    const json diagnosis = {{"ranking", {row("The first."), row("The second.")}}};
    const json found = findings_json({ball(1), ball(2), ball(3)}, diagnosis);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found[0]["words"], "The first.");
    EXPECT_EQ(found[1]["words"], "The second.");
    EXPECT_EQ(found[1]["center"], json({2.0, 0.0, 0.0}));
    EXPECT_THAT(found[2]["words"].get<std::string>(), HasSubstr("(3, 0, 0)")) << "of this one nothing was diagnosed";
}

/// Points of the triangles that are of a finding.
Points points_of(const mesh::PolyData& drawing, int finding) {
    const Eigen::MatrixXd& findings = drawing.data.cells[0].values;
    std::set<int> corners;
    for (Eigen::Index t = 0; t < drawing.triangles.rows(); ++t)
        if (findings(t, 0) == finding)
            corners.insert({drawing.triangles(t, 0), drawing.triangles(t, 1), drawing.triangles(t, 2)});
    Points points(std::ssize(corners), 3);
    Eigen::Index row = 0;
    for (const int corner : corners) points.row(row++) = drawing.points.row(corner);
    return points;
}

/// Each stands where it is in the body, and has its length and its radius.
TEST(FindingsFile, DrawsEachWhereItIs) {
    const TemporaryFolder scratch;
    skeleton::Model model = samples::make_lattice("cube", {3, 3, 2}, 1);
    model.effects = {
        {"gravity", {{"gx", 0, "mm/s^2"}, {"gy", 0, "mm/s^2"}, {"gz", -9810, "mm/s^2"}}},
        {"inclusion", {{"cx", 1, "mm"}, {"cy", 2, "mm"}, {"cz", 3, "mm"}, {"radius", 4, "mm"}, {"ratio", 8, "1"}}},
        {"contact", {{"nx", 0, "1"}, {"ny", 3, "1"}, {"nz", 4, "1"}, {"offset", -5, "mm"}, {"stiffness", 1, "N/mm^3"}}},
        {"compliant-support", {{"stiffness", 1, "N/mm"}, {"turning", 1, "1"}}}};
    identify::MeasurementSet set;
    set.markers = {{.id = 4, .rest = {1, 0, 0}, .anchor = {}}, {.id = 7, .rest = {0, 9, 0}, .anchor = {}}};
    const json diagnosis = {{"ranking", json::array()},
                            {"explanation", {"gravity"}},
                            {"exchanged_markers", {{{"probe", 1}, {"time", 0.0}, {"markers", {4, 7}}}}}};
    const std::filesystem::path file = scratch.path() / "findings.vtp";
    write_findings(file, model, set, diagnosis);

    const mesh::PolyData drawing = mesh::read_poly_data(file);
    ASSERT_EQ(drawing.data.cells[0].name, "finding");
    ASSERT_EQ(drawing.data.cells[1].name, "kind");
    const Points& skin = model.surface.vertices;
    const Vec3 low = skin.colwise().minCoeff().transpose(), high = skin.colwise().maxCoeff().transpose();
    const double size = (high - low).maxCoeff();
    const double tolerance = 1e-5 * size;  // the file's numbers are floats

    const Points arrow = points_of(drawing, 0);
    EXPECT_NEAR(arrow.col(2).maxCoeff() - arrow.col(2).minCoeff(), 0.25 * size, tolerance) << "straight down";
    EXPECT_LT(arrow.col(2).maxCoeff(), (low[2] + high[2]) / 2);

    ASSERT_EQ(drawing.data.cells[2].name, "ratio");
    for (Eigen::Index t = 0; t < drawing.triangles.rows(); ++t)
        EXPECT_EQ(drawing.data.cells[2].values(t, 0), drawing.data.cells[0].values(t, 0) == 1 ? 8 : 1);

    const Points ball = points_of(drawing, 1);
    for (Eigen::Index p = 0; p < ball.rows(); ++p)
        EXPECT_NEAR((ball.row(p).transpose() - Vec3(1, 2, 3)).norm(), 4, 4 * 1e-5);

    const Points wall = points_of(drawing, 2);
    EXPECT_LT((wall * Vec3(0, 0.6, 0.8) + Eigen::VectorXd::Constant(wall.rows(), 5)).cwiseAbs().maxCoeff(), tolerance);

    EXPECT_GT(points_of(drawing, 3).rows(), 0);
    const Points swapped = points_of(drawing, 4);
    EXPECT_NEAR(swapped.col(1).maxCoeff(), 9, 0.01 * size);
    EXPECT_EQ(drawing.data.cells[1].values.maxCoeff(), 5);
}

/// A component that is not determined is a line through the arrow's tip, a standard deviation long either way.
TEST(FindingsFile, DrawsHowFarAComponentIsNotDetermined) {
    const TemporaryFolder scratch;
    skeleton::Model model = samples::make_lattice("cube", {3, 3, 2}, 1);
    model.effects = {{"gravity", {{"gx", 1000, "mm/s^2"}, {"gy", 0, "mm/s^2"}, {"gz", -9000, "mm/s^2"}}}};
    const json diagnosis = {{"ranking",
                             {{{"effect", "gravity"},
                               {"parameters",
                                {{"gx", {{"value", 1000.0}, {"sd", 4000.0}}},
                                 {"gy", {{"value", 0.0}, {"sd", 100.0}}},
                                 {"gz", {{"value", -9000.0}, {"sd", 100.0}}}}}}}},
                            {"explanation", {"gravity"}}};
    write_findings(scratch.path() / "findings.vtp", model, {}, diagnosis);
    const Points drawn = points_of(mesh::read_poly_data(scratch.path() / "findings.vtp"), 0);
    const Points& skin = model.surface.vertices;
    const Vec3 low = skin.colwise().minCoeff().transpose(), high = skin.colwise().maxCoeff().transpose();
    const double size = (high - low).maxCoeff(), middle = (low[0] + high[0]) / 2, scale = 0.25 * size / 9000;
    const double tolerance = 1e-5 * size;  // the file's numbers are floats
    EXPECT_NEAR(drawn.col(0).minCoeff(), middle - 3000 * scale, tolerance);
    EXPECT_NEAR(drawn.col(0).maxCoeff(), middle + 5000 * scale, tolerance);
}

/// Nothing of an earlier run stays where nothing is found now.
TEST(FindingsFile, GoesWhereNothingIsFound) {
    const TemporaryFolder scratch;
    skeleton::Model model = samples::make_lattice("cube", {3, 3, 2}, 1);
    const std::filesystem::path file = scratch.path() / "findings.vtp";
    model.effects = {{"gravity", {{"gx", 0, "mm/s^2"}, {"gy", 0, "mm/s^2"}, {"gz", -9810, "mm/s^2"}}}};
    write_findings(file, model, {}, nullptr);
    ASSERT_TRUE(std::filesystem::exists(file));
    model.surface = {};  // spheres alone
    write_findings(file, model, {}, nullptr);
    EXPECT_GT(points_of(mesh::read_poly_data(file), 0).rows(), 0);
    model.effects.clear();
    write_findings(file, model, {}, nullptr);
    EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace palpate::pipeline
