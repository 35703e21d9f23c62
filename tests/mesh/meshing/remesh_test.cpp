#include "mesh/meshing/remesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/errors.h"
#include "mesh/topology/check_surface.h"
#include "mesh/topology/creases.h"
#include "tests/mesh/faulty_surfaces.h"
#include "tests/messages.h"

namespace palpate::mesh {
namespace {

double mean_edge(const Surface& surface) {
    double sum = 0;
    for (const auto& t : surface.triangles.rowwise())
        for (int i = 0; i < 3; ++i) sum += (surface.vertices.row(t[i]) - surface.vertices.row(t[(i + 1) % 3])).norm();
    return sum / static_cast<double>(surface.triangles.size());
}

TEST(Remesh, ABallKeepsItsVolumeAndIsSound) {
    const Surface ball = make_sphere({0, 0, 0}, 10, 4);
    const Surface coarse = remesh(ball, {.edge_length = 1.2});
    EXPECT_TRUE(check_surface(coarse).sound());
    EXPECT_NEAR(signed_volume(coarse), signed_volume(ball), 0.01 * signed_volume(ball));  // as promised
    EXPECT_NEAR(mean_edge(coarse), 1.2, 0.2);  // edges spread from 4/5 to 4/3 of the target
}

TEST(Remesh, ThinWallsKeepTheirTrianglesAndTheRestGetsNewOnes) {
    // Beside a ball, a shell of 0.1 mm: chords of 3 mm leave their sphere by l^2 / 8r = 0.11 mm, and cross the other
    // side.
    const Surface ball = make_sphere({0, 0, 0}, 10, 4), outer = make_sphere({30, 0, 0}, 10, 4);
    const Surface body = join(join(ball, outer), inside_out(make_sphere({30, 0, 0}, 9.9, 4)));
    const Surface coarse = remesh(body, {.edge_length = 3, .volume_change = 0.05});
    EXPECT_TRUE(check_surface(coarse).sound());
    Surface at_ball{coarse.vertices, Triangles(0, 3)};
    for (const auto& t : coarse.triangles.rowwise())
        if (coarse.vertices(t[0], 0) < 15) at_ball = with_triangle(at_ball, t[0], t[1], t[2]);
    EXPECT_NEAR(mean_edge(at_ball), 3, 0.4);
    EXPECT_GT(coarse.triangles.rows() - at_ball.triangles.rows(), outer.triangles.rows());
}

TEST(Remesh, ABoxKeepsItsCreasesExactly) {
    const Surface fine = remesh(make_box({0, 0, 0}, {40, 10, 10}, {1, 1, 1}), {.edge_length = 2});
    EXPECT_NEAR(signed_volume(fine), 4000, 1e-9);  // flat sides stay flat: round-off of projections
    EXPECT_NEAR(area(fine), 1800, 1e-9);
    EXPECT_NEAR(mean_edge(fine), 2, 0.3);
}

TEST(Remesh, AFlatCutStaysFlatThoughItsEdgeIsBlunt) {
    // A ball cut near its pole: the rim turns by 53 degrees (cos = 0.6), less than the crease angle.
    Surface cut = make_sphere({0, 0, 0}, 10, 4);
    for (auto vertex : cut.vertices.rowwise())
        if (vertex[2] > 6) vertex *= 6 / vertex[2];
    const Surface coarse = remesh(cut, {.edge_length = 1.5, .crease_angle = 80});
    const auto on_plane = [](const Surface& surface) {
        double sum = 0;
        const Points vectors = area_vectors(surface);
        for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
            bool flat = true;
            for (int i = 0; i < 3; ++i)
                flat = flat && std::abs(surface.vertices(surface.triangles(t, i), 2) - 6) < 1e-9;
            sum += flat ? vectors.row(t).norm() : 0;
        }
        return sum;
    };
    EXPECT_NEAR(on_plane(coarse), on_plane(cut), 0.03 * on_plane(cut));  // chords of the rim
}

TEST(Remesh, ThinBodiesGetShorterEdges) {
    const Surface plate = make_box({0, 0, 0}, {50, 50, 0.5}, {5, 5, 1});
    EXPECT_TRUE(check_surface(remesh(plate)).sound());
    // A rod of radius 1: edges of 3 mm would cut a third of it off.
    Surface rod = make_sphere({0, 0, 0}, 1, 4);
    for (auto vertex : rod.vertices.rowwise()) vertex[0] *= 25;
    const Surface remeshed = remesh(rod);
    EXPECT_TRUE(check_surface(remeshed).sound());
    EXPECT_NEAR(signed_volume(remeshed), signed_volume(rod), 0.01 * signed_volume(rod));
    EXPECT_LT(mean_edge(remeshed), 2);
}

TEST(Remesh, CavitiesStay) {
    const Surface remeshed = remesh(hollow_ball(), {.edge_length = 1.5});
    EXPECT_TRUE(check_surface(remeshed).sound());
    EXPECT_EQ(check_surface(remeshed).components, 2);
}

TEST(Creases, OfABoxAreItsTwelveEdgesAndEightCorners) {
    const Creases creases = find_creases(cube(), 60);
    EXPECT_EQ(creases.edges.size(), 12u * 4);
    EXPECT_EQ(creases.corners.size(), 8u);
    EXPECT_TRUE(find_creases(make_sphere({0, 0, 0}, 1, 3), 60).edges.empty());
}

TEST(Remesh, RefusesWhatItCannotDo) {
    EXPECT_TRUE(says(message_of<InvalidInput>([] { remesh(inside_out(cube())); }), {"outward", "Repair"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([] { remesh(with_fin(cube())); }), {"Repair"}));
    EXPECT_TRUE(
        says(message_of<SolverFailure>([] { remesh(cube(), {.edge_length = 0.001}); }), {"0.001 mm", "triangles"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([] { remesh(cube(), {.edge_length = -1}); }), {"edge_length", "-1"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([] { remesh(cube(), {.crease_angle = 180}); }), {"crease_angle", "180"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([] { remesh(cube(), {.iterations = 0}); }), {"iterations", "0"}));
}

}  // namespace
}  // namespace palpate::mesh
