// Parts of a body of materials of their own: their surfaces, and the elements that follow them.

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/formats/read_body.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/meshing/remesh.h"
#include "mesh/meshing/tetrahedralise.h"
#include "mesh/regions/check_regions.h"
#include "mesh/regions/element_regions.h"
#include "mesh/regions/interfaces.h"
#include "mesh/topology/check_surface.h"
#include "tests/mesh/faulty_surfaces.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

Surface long_bar() { return make_box({0, 0, 0}, {60, 20, 20}, {12, 4, 4}); }
MaterialRegion ball(const std::string& name, const Vec3& at, double radius) {
    return {.name = name, .surface = make_sphere(at, radius, 3)};
}

/// What the elements of each region fill; the last one is of none [mm^3].
std::vector<double> volumes_of(const VolumeMesh& mesh, const std::vector<Surface>& surfaces) {
    const std::vector<int> region = regions_of_elements(mesh, surfaces);
    const Eigen::VectorXd volumes = element_volumes(mesh);
    std::vector<double> result(surfaces.size() + 1, 0.0);
    for (std::size_t e = 0; e < region.size(); ++e)
        result[region[e] < 0 ? surfaces.size() : static_cast<std::size_t>(region[e])] +=
            volumes[static_cast<Eigen::Index>(e)];
    return result;
}

std::vector<Surface> followed_by_all(const std::vector<MaterialRegion>& regions, const Surface& body) {
    const Interfaces interfaces = remesh_interfaces(regions, body, 5);
    EXPECT_EQ(interfaces.followed().size(), regions.size());
    return interfaces.surfaces;
}

std::string refusal(const std::vector<MaterialRegion>& regions, const Surface& body = long_bar()) {
    return message_of<InvalidInput>([&] { check_regions(regions, body, "set.yaml"); });
}

TEST(Regions, ElementsEndAtTheirSurfaces) {
    // One alone, and a core within a ball.
    const std::vector<MaterialRegion> regions{ball("core", {40, 10, 10}, 3), ball("lump", {15, 10, 10}, 5),
                                              ball("shell", {40, 10, 10}, 7)};
    check_regions(regions, long_bar(), "set.yaml");
    const Surface body = remesh(long_bar(), {.edge_length = 5});
    const std::vector<Surface> interfaces = followed_by_all(regions, body);
    const VolumeMesh mesh = tetrahedralise_within(body, interfaces, {.edge_length = 5});
    const std::vector<double> volumes = volumes_of(mesh, interfaces);
    const auto of = [&](std::size_t r) { return signed_volume(regions[r].surface); };
    constexpr double chords = 2e-3;  // the vertices have moved out by what chords cut off, to first order
    EXPECT_NEAR(volumes[0], of(0), chords * of(0));
    EXPECT_NEAR(volumes[1], of(1), chords * of(1));
    EXPECT_NEAR(volumes[2], of(2) - of(0), chords * of(2));
    EXPECT_NEAR(volumes[0] + volumes[1] + volumes[2] + volumes[3], signed_volume(body), 1e-9 * signed_volume(body));
    // The body's boundary is its own alone.
    EXPECT_EQ(mesh.faces.rows(), body.triangles.rows());
}

TEST(Regions, ThinLayersBetweenThemAreKept) {
    // Between two boxes, 0.4 mm; to the surface of the body 0.5 mm.
    const std::vector<MaterialRegion> regions{
        {.name = "left", .surface = make_box({5, 0.5, 5}, {29.8, 19.5, 15}, {1, 1, 1})},
        {.name = "right", .surface = make_box({30.2, 0.5, 5}, {55, 19.5, 15}, {1, 1, 1})}};
    check_regions(regions, long_bar(), "set.yaml");
    const Surface body = remesh(long_bar(), {.edge_length = 5});
    const std::vector<Surface> interfaces = followed_by_all(regions, body);
    const VolumeMesh mesh = tetrahedralise_within(body, interfaces, {.edge_length = 5});
    const double each = 24.8 * 19 * 10;
    const std::vector<double> volumes = volumes_of(mesh, interfaces);
    EXPECT_NEAR(volumes[0], each, 1e-6 * each);  // flat sides have no chords
    EXPECT_NEAR(volumes[1], each, 1e-6 * each);
}

TEST(Regions, ThatContradictTheBodyOrEachOtherAreRefused) {
    EXPECT_EQ(refusal({ball("a", {15, 10, 10}, 5), ball("b", {15, 10, 10}, 3)}), "");
    EXPECT_TRUE(says(refusal({ball("a", {15, 10, 10}, 5), ball("b", {19, 10, 10}, 5)}),
                     {"set.yaml", "'a' and 'b' overlap", "one within another"}));
    EXPECT_TRUE(says(refusal({ball("a", {15, 10, 10}, 5), ball("b", {15, 10, 10}, 5)}), {"'a' and 'b'", "same part"}));
    EXPECT_TRUE(says(refusal({ball("a", {15, 10, 2}, 5)}), {"'a' reaches 3 mm out", "15, 10, -3", "Cut"}));
    EXPECT_TRUE(says(refusal({ball("a", {15, 10, 40}, 5)}), {"'a'", "outside of the body", "unit"}));
    EXPECT_TRUE(says(refusal({ball("a", {0, 0, 0}, 2)}, hollow_ball()), {"'a'", "outside of the body's material"}));
    EXPECT_TRUE(says(refusal({ball("a", {15, 10, 10}, 0.2)}), {"'a'", "0.32", "at least 0.6 mm", "take it out"}));
    MaterialRegion crossed = ball("a", {15, 10, 10}, 3);
    crossed.surface = join(crossed.surface, make_sphere({18, 10, 10}, 3, 2));
    EXPECT_TRUE(says(refusal({crossed}), {"'a'", "bounds no body", "palpate check"}));
}

TEST(Regions, MayTouchTheBodyAndEachOther) {
    // Two halves of the bar, whole; a ball in one of them. Elements follow the ball alone.
    const std::vector<MaterialRegion> regions{{.name = "root", .surface = make_box({0, 0, 0}, {30, 20, 20}, {1, 1, 1})},
                                              {.name = "tip", .surface = make_box({30, 0, 0}, {60, 20, 20}, {1, 1, 1})},
                                              ball("ball", {15, 10, 10}, 5)};
    EXPECT_EQ(refusal(regions), "");
    const Surface body = remesh(long_bar(), {.edge_length = 5});
    // Of two that lie side by side within the body the larger one is followed.
    const std::vector<MaterialRegion> beside{
        {.name = "small", .surface = make_box({20, 5, 5}, {25, 15, 15}, {1, 1, 1})},
        {.name = "large", .surface = make_box({25, 5, 5}, {40, 15, 15}, {1, 1, 1})}};
    EXPECT_EQ(remesh_interfaces(beside, body, 5).is_followed, (std::vector<char>{0, 1}));
    const Interfaces interfaces = remesh_interfaces(regions, body, 5);
    EXPECT_EQ(interfaces.is_followed, (std::vector<char>{0, 0, 1}));
    const VolumeMesh mesh = tetrahedralise_within(body, interfaces.followed(), {.edge_length = 5});
    const std::vector<double> volumes = volumes_of(mesh, interfaces.surfaces);
    const double of_ball = signed_volume(regions[2].surface);
    EXPECT_NEAR(volumes[2], of_ball, 2e-3 * of_ball);  // chords, as above
    // Elements of 5 mm, 15 mm^3 each, at a plane that they do not end at: 50 or so belong to a side by their centres
    // and are off by a third of themselves, at random. Three standard deviations.
    const double random = 3 * std::sqrt(50) * 15 / 3;
    EXPECT_NEAR(volumes[0], 12000 - of_ball, random);
    EXPECT_NEAR(volumes[1], 12000, random);
    EXPECT_EQ(volumes[3], 0);
}

TEST(Regions, AreToldByLabelsOfElements) {
    const TemporaryFolder folder;
    const VolumeMesh bar = to_quadratic(make_bar({0, 0, 0}, {60, 20, 20}, {6, 2, 2}));
    Eigen::MatrixXd label(bar.tetrahedra.rows(), 1);
    for (Eigen::Index e = 0; e < label.rows(); ++e)
        label(e) = bar.nodes(bar.tetrahedra.row(e).head<4>(), 0).mean() < 20 ? 7 : 3;
    write_vtu(folder / "bar.vtu", bar, {.points = {}, .cells = {{"region", label}}});
    const BodyFile body = read_body(folder / "bar.vtu", {.label = {}, .parts = {3, 7}});
    ASSERT_EQ(body.parts.size(), 2U);
    EXPECT_NEAR(signed_volume(body.parts[0]), 16000, 1e-9);
    EXPECT_NEAR(signed_volume(body.parts[1]), 8000, 1e-9);
    EXPECT_TRUE(check_surface(body.parts[1]).sound());
    const std::vector<int> region = regions_of_elements(*body.volume, body.parts);
    for (std::size_t e = 0; e < region.size(); ++e)
        EXPECT_EQ(region[e], label(static_cast<Eigen::Index>(e)) == 3 ? 0 : 1);

    const auto refusal_of = [&](const char* file, int wanted) {
        return message_of<InvalidInput>([&] { read_body(folder / file, {.label = {}, .parts = {wanted}}); });
    };
    EXPECT_TRUE(says(refusal_of("bar.vtu", 5), {"bar.vtu", "no element has the label 5", "3 (96 elements)"}));
    write_vtu(folder / "plain.vtu", bar);
    EXPECT_TRUE(says(refusal_of("plain.vtu", 5), {"plain.vtu", "no materials", "label 5", "cell array"}));
    write_surface(folder / "bar.stl", long_bar());
    EXPECT_TRUE(says(refusal_of("bar.stl", 5), {"bar.stl", "no labels", "'surface'"}));
}

TEST(Regions, TooCloseForTrianglesAreAnError) {
    // A ball within a ball, a hundredth of a millimetre apart: chords of no allowed length pass between.
    const std::vector<MaterialRegion> regions{ball("core", {30, 10, 10}, 6), ball("shell", {30, 10, 10}, 6.01)};
    const Surface body = remesh(long_bar(), {.edge_length = 5});
    EXPECT_TRUE(says(message_of<SolverFailure>([&] { remesh_interfaces(regions, body, 5); }),
                     {"region 'core'", "so close", "Move them apart"}));
}

}  // namespace
}  // namespace palpate::mesh
