#include "mesh/core/surface.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <utility>

namespace palpate::mesh {
namespace {

/// Edges that do not run once in each direction: none where a surface is closed and consistently oriented.
int open_edges(const Surface& surface) {
    std::map<std::pair<int, int>, int> balance;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const int a = surface.triangles(t, c);
            const int b = surface.triangles(t, (c + 1) % 3);
            balance[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    int open = 0;
    for (const auto& [edge, sum] : balance) open += sum != 0;
    return open;
}

int euler_characteristic(const Surface& surface) {
    const auto faces = static_cast<int>(surface.triangles.rows());
    return static_cast<int>(surface.vertices.rows()) - faces * 3 / 2 + faces;
}

TEST(MakeBox, IsClosedOutwardAndOfTheRightSize) {
    const Surface box = make_box({-1, 2, 3}, {9, 5, 4}, {4, 2, 3});
    EXPECT_EQ(open_edges(box), 0);
    EXPECT_EQ(euler_characteristic(box), 2);  // a sphere's: every vertex is used, none twice
    EXPECT_EQ(box.triangles.rows(), 2 * 2 * (4 * 2 + 2 * 3 + 3 * 4));
    EXPECT_NEAR(signed_volume(box), 30, 1e-12);  // round-off of some hundred terms
    EXPECT_NEAR(area(box), 2 * (30 + 10 + 3), 1e-12);
    EXPECT_EQ(bounding_box(box.vertices).min, Vec3(-1, 2, 3));
    EXPECT_EQ(bounding_box(box.vertices).max, Vec3(9, 5, 4));
    EXPECT_EQ(bounding_box(box.vertices).longest_side(), 10);
}

TEST(MakeSphere, IsClosedOutwardAndTendsToTheSphere) {
    const double exact = 4 * std::numbers::pi / 3 * 8;
    double previous = exact;
    for (const int levels : {0, 1, 2, 3}) {
        const Surface sphere = make_sphere({5, 6, 7}, 2, levels);
        EXPECT_EQ(open_edges(sphere), 0);
        EXPECT_EQ(euler_characteristic(sphere), 2);
        EXPECT_TRUE(
            ((sphere.vertices.rowwise() - Eigen::RowVector3d(5, 6, 7)).rowwise().norm().array() - 2).abs().maxCoeff() <
            1e-14);
        // The error of a polyhedron falls with the square of its edges; the icosahedron itself misses 39 %.
        const double error = exact - signed_volume(sphere);
        EXPECT_GT(error, 0);
        EXPECT_LT(error, levels == 0 ? 0.4 * exact : previous / 3);
        previous = error;
    }
}

TEST(Surface, VolumeAndAreaDoNotDependOnThePlace) {
    Surface box = make_box({0, 0, 0}, {1, 1, 1}, {2, 2, 2});
    box.vertices.rowwise() += Eigen::RowVector3d(1e6, -1e6, 1e6);
    // Coordinates of 1e6 carry 1e-10: the volume loses no more.
    EXPECT_NEAR(signed_volume(box), 1, 1e-8);
    EXPECT_NEAR(area(box), 6, 1e-8);
}

TEST(Surface, TurnedInsideOutHasNegativeVolume) {
    Surface box = make_box({0, 0, 0}, {1, 2, 3}, {1, 1, 1});
    box.triangles.col(0).swap(box.triangles.col(1));
    EXPECT_NEAR(signed_volume(box), -6, 1e-12);
}

TEST(Surface, AreaVectorsOfAClosedSurfaceCancel) {
    const Surface sphere = make_sphere({0, 0, 0}, 3, 2);
    const Points vectors = area_vectors(sphere);
    EXPECT_LT(vectors.colwise().sum().norm(), 1e-12);
    EXPECT_NEAR(vectors.rowwise().norm().sum(), area(sphere), 1e-12);
}

TEST(VertexNormals, PointFromACubesCornersAlongTheDiagonals) {
    // By angle, and not by triangle: it does not matter how the sides are cut.
    const Surface cube = make_box({-1, -1, -1}, {1, 1, 1}, {1, 1, 1});
    const Points expected = cube.vertices.rowwise().normalized();
    EXPECT_LT((vertex_normals(cube) - expected).cwiseAbs().maxCoeff(), 1e-14);
}

}  // namespace
}  // namespace palpate::mesh
