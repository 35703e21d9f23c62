#include "mesh/geometry/surface_tree.h"

#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "mesh/errors.h"
#include "tests/mesh/faulty_surfaces.h"
#include "tests/messages.h"

namespace palpate::mesh {
namespace {

TEST(SurfaceTree, DistanceToABoxIsExact) {
    const SurfaceTree tree(cube());
    EXPECT_DOUBLE_EQ(tree.closest({5, 5, 13}).distance, 3);    // from a side
    EXPECT_DOUBLE_EQ(tree.closest({13, 5, 14}).distance, 5);   // from an edge
    EXPECT_DOUBLE_EQ(tree.closest({12, 13, 16}).distance, 7);  // from a corner: 2, 3, 6
    EXPECT_DOUBLE_EQ(tree.closest({5, 6, 8}).distance, 2);     // from inside
    EXPECT_EQ(tree.closest({10, 3, 4}).distance, 0);
}

TEST(SurfaceTree, PositionLiesInItsTriangleAndIsNearest) {
    const Surface ball = make_sphere({1, 2, 3}, 4, 2);
    const SurfaceTree tree(ball);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> coordinate(-6, 8);
    for (int k = 0; k < 200; ++k) {
        const Vec3 point(coordinate(random), coordinate(random), coordinate(random));
        const SurfacePoint found = tree.closest(point);
        EXPECT_GE(found.barycentric.minCoeff(), -1e-12);  // round-off of the weights
        EXPECT_NEAR(found.barycentric.sum(), 1, 1e-12);
        Vec3 position = Vec3::Zero();
        for (int i = 0; i < 3; ++i)
            position += found.barycentric[i] * ball.vertices.row(ball.triangles(found.triangle, i)).transpose();
        EXPECT_LT((position - found.position).norm(), 1e-12);
        EXPECT_DOUBLE_EQ(found.distance, (point - found.position).norm());
        const double to_vertices = (ball.vertices.rowwise() - point.transpose()).rowwise().norm().minCoeff();
        EXPECT_LE(found.distance, to_vertices + 1e-12);
    }
}

TEST(SurfaceTree, InsideKnowsCavities) {
    const SurfaceTree tree(hollow_ball());
    EXPECT_FALSE(tree.inside({0, 0, 0}));
    EXPECT_TRUE(tree.inside({7, 0, 0}));
    EXPECT_TRUE(tree.inside({0, -7, 0}));
    EXPECT_FALSE(tree.inside({9, 9, 0}));
    EXPECT_FALSE(tree.inside({100, 0, 0}));
}

TEST(SurfaceTree, InsideIsRightWhereRaysWouldGraze) {
    // On a regular box lattice points, edges and diagonals line up; the border belongs to the inside.
    const SurfaceTree tree(cube());
    for (double x = -2.5; x <= 12.5; x += 2.5)
        for (double y = -2.5; y <= 12.5; y += 2.5)
            for (double z = -2.5; z <= 12.5; z += 2.5)
                EXPECT_EQ(tree.inside({x, y, z}), std::min({x, y, z}) >= 0 && std::max({x, y, z}) <= 10)
                    << x << " " << y << " " << z;
}

TEST(SurfaceTree, ThreadsGetTheSameAnswers) {
    const SurfaceTree tree(make_sphere({0, 0, 0}, 1, 3));
    const auto distances = [&] {
        std::vector<double> result;
        for (int k = 0; k < 500; ++k) {
            const Vec3 point(0.003 * k, 0.5 - 0.001 * k, 0.2);
            result.push_back(tree.closest(point).distance + (tree.inside(point) ? 1 : 0));
        }
        return result;
    };
    const std::vector<double> alone = distances();
    std::vector<std::vector<double>> found(4);
    std::vector<std::thread> threads;
    for (auto& result : found) threads.emplace_back([&] { result = distances(); });
    for (auto& thread : threads) thread.join();
    for (const auto& result : found) EXPECT_EQ(result, alone);
}

TEST(SurfaceTree, RefusesASurfaceWithoutArea) {
    EXPECT_TRUE(says(message_of<InvalidInput>([] {
                         SurfaceTree(Surface{Points(0, 3), Triangles(0, 3)});
                     }),
                     {"no triangle"}));
}

}  // namespace
}  // namespace palpate::mesh
