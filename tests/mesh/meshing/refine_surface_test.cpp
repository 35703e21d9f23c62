#include "mesh/meshing/refine_surface.h"

#include <gtest/gtest.h>

#include "mesh/topology/check_surface.h"

namespace palpate::mesh {
namespace {

const Vec3 corner(10, 10, 10);

/// Edges of half a millimetre about a corner, of 4 far away.
double wanted(const Vec3& place) { return std::min(4.0, 0.5 + 0.5 * (place - corner).norm()); }

TEST(RefineSurface, KeepsABodyAndMakesEdgesAsShortAsWanted) {
    const Surface box = make_box({0, 0, 0}, corner, {1, 1, 1});
    const Surface fine = refine_surface(box, wanted);
    EXPECT_TRUE(check_surface(fine).sound());
    EXPECT_NEAR(signed_volume(fine), 1000, 1e-9);
    EXPECT_NEAR(area(fine), 600, 1e-9);
    EXPECT_EQ(fine.vertices.topRows(box.vertices.rows()), box.vertices);
    int short_ones = 0;
    for (Eigen::Index t = 0; t < fine.triangles.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const Vec3 a = fine.vertices.row(fine.triangles(t, c)),
                       b = fine.vertices.row(fine.triangles(t, (c + 1) % 3));
            EXPECT_LE((b - a).norm(), wanted((a + b) / 2) * (1 + 1e-12));
            short_ones += (b - a).norm() < 0.6 ? 1 : 0;
        }
    EXPECT_GT(short_ones, 10);
    // Halving overshoots by two: at most some four times the triangles of the length that was wanted.
    double needed = 0;
    for (const auto& t : fine.triangles.rowwise()) {
        const Vec3 a = fine.vertices.row(t[0]), b = fine.vertices.row(t[1]), c = fine.vertices.row(t[2]);
        const double h = wanted((a + b + c) / 3);
        needed += (b - a).cross(c - a).norm() / 2 / (0.43 * h * h);
    }
    EXPECT_LT(static_cast<double>(fine.triangles.rows()), 5 * needed);
}

TEST(RefineSurface, LeavesWhatIsFineEnough) {
    const Surface ball = make_sphere({0, 0, 0}, 10, 3);
    const Surface same = refine_surface(ball, [](const Vec3&) { return 100.0; });
    EXPECT_EQ(same.vertices, ball.vertices);
    EXPECT_EQ(same.triangles, ball.triangles);
}

}  // namespace
}  // namespace palpate::mesh
