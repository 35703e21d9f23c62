#include "mesh/geometry/local_thickness.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::mesh {
namespace {

TEST(LocalThickness, OfAPlateIsItsThickness) {
    EXPECT_NEAR(local_thickness(make_box({0, 0, 0}, {100, 60, 4}, {25, 15, 1})), 4, 1e-9);
    EXPECT_NEAR(local_thickness(make_box({0, 0, 0}, {100, 60, 4}, {1, 1, 1})), 4, 1e-9);
}

TEST(LocalThickness, OfABarIsNearlyItsWidth) {
    // At d from an edge the largest ball has a diameter of 2 d: nine tenths of the skin have up to 0.9 of the width.
    EXPECT_NEAR(local_thickness(make_box({0, 0, 0}, {80, 10, 10}, {40, 20, 20})), 9, 0.5);
}

TEST(LocalThickness, OfABentPlateIsItsThickness) {
    Surface shell = make_box({0, 0, 0}, {60, 4, 40}, {60, 1, 40});
    for (Eigen::Index v = 0; v < shell.vertices.rows(); ++v) {
        const double angle = shell.vertices(v, 0) / 50, radius = 50 - shell.vertices(v, 1);
        shell.vertices.row(v) << radius * std::sin(angle), 50 - radius * std::cos(angle), shell.vertices(v, 2);
    }
    EXPECT_NEAR(local_thickness(shell), 4, 1.0 / (8 * 50));  // how deep a facet of 1 mm lies in its arc of 50 mm
}

}  // namespace
}  // namespace palpate::mesh
