#include "mesh/supports/support_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/core/convex_hull.h"
#include "mesh/supports/held_parts.h"

namespace palpate::mesh {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Points on the end x = 0 of a bar of 100 x 20 x 20: a grid over y from 0 to `width`, z from 0 to 20.
Points on_the_end(double spacing, double width = 20, double x = 0) {
    std::vector<Vec3> points;
    for (double y = 0; y <= width + 1e-9; y += spacing)
        for (double z = 0; z <= 20 + 1e-9; z += spacing) points.emplace_back(x, y, z);
    Points rows(std::ssize(points), 3);
    for (std::size_t i = 0; i < points.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = points[i];
    return rows;
}

Surface bar() { return make_box({0, 0, 0}, {100, 20, 20}, {20, 4, 4}); }
VolumeMesh elements() { return to_quadratic(make_bar({0, 0, 0}, {100, 20, 20}, {15, 3, 3})); }  // 6.7 mm long

/// Of the elements' nodes, how many are held.
Eigen::Index held(const std::vector<Region>& regions) {
    const std::vector<char> flags = contains(regions, elements().nodes);
    return std::ranges::count(flags, 1);
}
constexpr Eigen::Index nodes_of_the_end = 49;  // 7 x 7, midsides with them

TEST(ConvexHull, ReachesWhatLiesBetweenItsCorners) {
    Points corners(4, 3);
    corners << 0, 0, 0, 4, 0, 0, 0, 4, 0, 4, 4, 0;
    EXPECT_TRUE(is_near_hull(corners, {2, 2, 0.4}, 0.5));
    EXPECT_TRUE(is_near_hull(corners, {1, 3, -0.49}, 0.5));
    EXPECT_FALSE(is_near_hull(corners, {2, 2, 0.51}, 0.5));
    EXPECT_FALSE(is_near_hull(corners, {4.6, 2, 0}, 0.5));
    EXPECT_TRUE(is_near_hull(corners.topRows(1), {0, 0, 0.5}, 0.5));
}

TEST(SupportPoints, HoldTheirPatchWhateverTheirDistance) {
    for (const double spacing : {1.0, 4.0, 5.0}) {
        const std::vector<Region> points{PointsRegion{on_the_end(spacing), 0.5}};
        const PatchedSupports made = patched(points, bar(), 7);
        EXPECT_EQ(held(made.regions), nodes_of_the_end) << spacing;
        EXPECT_THAT(made.notes, ElementsAre(HasSubstr("are joined"))) << spacing;
        EXPECT_THAT(made.warnings, IsEmpty()) << spacing;
        // the end face, and of the four sides half a millimetre
        EXPECT_NEAR(held_parts(made.regions, bar(), 0.1)[0].area, 400 + 4 * 20 * 0.5, 1) << spacing;
    }
    EXPECT_LT(held({PointsRegion{on_the_end(4), 0.5}}), 10);  // point by point
}

TEST(SupportPoints, StayAsTheyAreWhereTheyCoverTheirPatch) {
    const PatchedSupports made = patched({PointsRegion{on_the_end(1), 1}}, bar(), 7);
    EXPECT_THAT(made.notes, IsEmpty());
    EXPECT_LT(std::get<PointsRegion>(made.regions[0]).joined, 0);
}

TEST(SupportPoints, FurtherApartThanAnElementAreNotJoined) {
    const PatchedSupports made = patched({PointsRegion{on_the_end(20), 0.5}}, bar(), 7);  // the four corners
    EXPECT_FALSE(contains(made.regions, Vec3(0, 10, 10)));
    EXPECT_TRUE(contains(made.regions, Vec3(0, 2, 2)));  // half an element round each
    EXPECT_THAT(made.notes, ElementsAre(HasSubstr("round 4 of its 4 points")));
}

TEST(SupportPoints, WhatIsNarrowerThanAnElementReachesHalfOfOne) {
    const PatchedSupports made = patched({PointsRegion{on_the_end(0.5, 0.5), 0.2}}, bar(), 7);  // a strip, 0.5 mm wide
    EXPECT_THAT(patched({PointsRegion{on_the_end(0.5, 0.5), 0.2}}, bar(), 7, "Tool 'pad', region").notes,
                AllOf(Not(IsEmpty()), Each(HasSubstr("Tool 'pad', region 1: "))));
    ASSERT_EQ(made.regions.size(), 2u);
    EXPECT_TRUE(contains(made.regions, Vec3(0, 3.9, 10)));
    EXPECT_FALSE(contains(made.regions, Vec3(0, 4.1, 10)));
    EXPECT_THAT(patched(made.regions, bar(), 7).notes, IsEmpty());  // it is done once
}

TEST(SupportPoints, OffTheBodyAreTold) {
    EXPECT_THAT(patched({PointsRegion{on_the_end(4, 20, -3), 0.5}}, bar(), 7).warnings,
                ElementsAre(AllOf(HasSubstr("36 of its 36 points lie further"), HasSubstr("(-3, 0, 0)"))));
}

TEST(HeldParts, TellNodesAndAreaOfEachSupport) {
    const std::vector<Region> regions{BoxRegion{{-1, -1, -1}, {0, 21, 21}}, SphereRegion{{50, 50, 50}, 1}};
    const auto parts = held_parts(regions, elements());
    EXPECT_EQ(parts[0].nodes, nodes_of_the_end);
    EXPECT_NEAR(parts[0].area, 400, 1e-9);
    EXPECT_EQ(parts[1].nodes, 0);
    EXPECT_EQ(describe_held_part(regions, parts, 0, "nodes"), "support 1 (box): 49 nodes, 400 mm^2 of the surface");
    EXPECT_EQ(surface_in_words(1.94123e3), "1941 mm^2 of the surface");
    EXPECT_EQ(surface_in_words(1.94123), "1.94 mm^2 of the surface");
}

TEST(HeldParts, TooLittleIsToldInItsKind) {
    const auto told = [](const std::vector<Region>& regions) { return too_little_held(regions, elements()); };
    const Region end = BoxRegion{{-1, -1, -1}, {0, 21, 21}};
    EXPECT_THAT(told({end}), IsEmpty());
    EXPECT_THAT(told({end, SphereRegion{{50, 50, 50}, 1}}), ElementsAre(HasSubstr("Support 2 (sphere) holds no node")));
    EXPECT_THAT(told({PointsRegion{on_the_end(20), 0.5}}), ElementsAre(HasSubstr("4 of ")));
    EXPECT_THAT(told({PointsRegion{on_the_end(20), 0.5}}), ElementsAre(HasSubstr("singly")));
    EXPECT_THAT(told({BoxRegion{{-1, -1, -1}, {0, 6.7, 6.7}}}), IsEmpty());  // a side, of elements 6.7 mm long
}

}  // namespace
}  // namespace palpate::mesh
