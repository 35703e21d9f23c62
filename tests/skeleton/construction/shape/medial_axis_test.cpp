#include "skeleton/construction/shape/medial_axis.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace palpate::skeleton {
namespace {

MedialAxis axis_of(const mesh::Surface& surface, double spacing) {
    return medial_axis(surface, mesh::SurfaceTree(surface), spacing);
}

TEST(MedialAxis, ABallsAxisIsItsCentre) {
    const Vec3 center(3, -2, 7);
    const MedialAxis axis = axis_of(mesh::make_sphere(center, 10, 3), 2);
    ASSERT_GT(axis.radii.size(), 100);
    // Facets of an icosphere of 8^2 x 20 leave 0.04 of the radius; balls that follow the facets would be several times
    // smaller than the sphere.
    for (Eigen::Index i = 0; i < axis.radii.size(); ++i) {
        EXPECT_NEAR(axis.radii(i), 10, 0.4);
        EXPECT_LT((axis.centers.row(i).transpose() - center).norm(), 0.4);
    }
}

TEST(MedialAxis, BallsLieInsideAndTouchTheSurface) {
    const mesh::Surface box = mesh::make_box(Vec3(0, 0, 0), Vec3(60, 30, 20), {6, 3, 2});
    const mesh::SurfaceTree tree(box);
    const MedialAxis axis = medial_axis(box, tree, 2);
    ASSERT_GT(axis.radii.size(), 500);
    for (Eigen::Index i = 0; i < axis.radii.size(); ++i) {
        const Vec3 center = axis.centers.row(i);
        EXPECT_TRUE(tree.inside(center));
        EXPECT_NEAR(axis.radii(i), tree.closest(center).distance, 1e-9);
        EXPECT_LE(axis.radii(i), 10 + 1e-9);
        EXPECT_NEAR((axis.touching.row(i) - axis.centers.row(i)).norm(), axis.radii(i), 1e-9);
    }
}

TEST(MedialAxis, AWallThinnerThanTheSamplesAreApartHasItsMiddleSheet) {
    // Two millimetres thick, twelve triangles, samples five millimetres apart.
    const MedialAxis axis = axis_of(mesh::make_box(Vec3(0, 0, 0), Vec3(100, 80, 2), {1, 1, 1}), 5);
    int on_large_sides = 0, on_sheet = 0;
    for (Eigen::Index i = 0; i < axis.radii.size(); ++i) {
        if (std::abs(axis.touching(i, 2) - 1) < 1 - 1e-9) continue;
        ++on_large_sides;
        on_sheet += std::abs(axis.centers(i, 2) - 1) < 1e-3 && std::abs(axis.radii(i) - 1) < 1e-3;
    }
    // All but those within a millimetre of an edge.
    EXPECT_GT(on_large_sides, 100);
    EXPECT_GT(on_sheet, 0.9 * on_large_sides);
}

TEST(MedialAxis, TheSameSurfaceGivesTheSameBalls) {
    const mesh::Surface box = mesh::make_box(Vec3(0, 0, 0), Vec3(60, 30, 20), {6, 3, 2});
    const MedialAxis first = axis_of(box, 3), second = axis_of(box, 3);
    EXPECT_EQ(first.centers, second.centers);
    EXPECT_EQ(first.radii, second.radii);
}

}  // namespace
}  // namespace palpate::skeleton
