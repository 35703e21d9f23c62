#include "mesh/core/region.h"

#include <gtest/gtest.h>

namespace palpate::mesh {
namespace {

TEST(Region, BordersBelongToIt) {
    EXPECT_TRUE(contains(BoxRegion{{0, 0, 0}, {1, 2, 3}}, {1, 2, 3}));
    EXPECT_FALSE(contains(BoxRegion{{0, 0, 0}, {1, 2, 3}}, {1.001, 2, 3}));
    EXPECT_TRUE(contains(SphereRegion{{1, 1, 1}, 2}, {3, 1, 1}));
    EXPECT_FALSE(contains(SphereRegion{{1, 1, 1}, 2}, {3.001, 1, 1}));
    EXPECT_TRUE(contains(PlaneRegion{{0, 0, 5}, {0, 0, -7}, 0.5}, {100, 100, 5.5}));
    EXPECT_TRUE(contains(PlaneRegion{{0, 0, 5}, {0, 0, -7}, 0.5}, {100, 100, 4.5}));
    EXPECT_FALSE(contains(PlaneRegion{{0, 0, 5}, {0, 0, -7}, 0.5}, {100, 100, 5.501}));
    Points two(2, 3);
    two << 0, 0, 0, 10, 0, 0;
    EXPECT_TRUE(contains(PointsRegion{two, 1}, {10, 1, 0}));
    EXPECT_FALSE(contains(PointsRegion{two, 1}, {5, 0, 0}));
}

TEST(Region, BordersBelongToItAfterSinglePrecision) {
    // An STL file keeps 0.1 as 0.100000001490116.
    const double from_file = static_cast<double>(0.1F);
    ASSERT_GT(from_file, 0.1);
    EXPECT_TRUE(contains(BoxRegion{{0, 0, 0}, {0.1, 1, 1}}, {from_file, 0, 0}));
    EXPECT_TRUE(contains(PlaneRegion{{0, 0, 0}, {1, 0, 0}, 0.1}, {from_file, 0, 0}));
}

TEST(Regions, AreUnited) {
    const std::vector<Region> regions{BoxRegion{{0, 0, 0}, {1, 1, 1}}, SphereRegion{{5, 0, 0}, 1}};
    Points points(3, 3);
    points << 0.5, 0.5, 0.5, 5.5, 0, 0, 3, 0, 0;
    EXPECT_EQ(contains(regions, points), (std::vector<char>{1, 1, 0}));
    EXPECT_FALSE(contains(std::vector<Region>{}, Vec3(0, 0, 0)));
}

}  // namespace
}  // namespace palpate::mesh
