#include "skeleton/effects/point_sets.h"

#include <gtest/gtest.h>

#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using testing::compliant_support;
using testing::force_at;
using testing::lattice_with_skin;
using testing::make_chain;
using testing::make_lattice;
using testing::with_effects;

TEST(PointSets, MaterialWeighsWhatTheBodyWeighs) {
    const PointSet set = point_set(make_lattice({3, 2, 2}), fem::ActsOn::material);
    EXPECT_EQ(set.at.size(), 12u);
    EXPECT_NEAR(set.weights.sum(), 12e-6, 1e-18);
}

TEST(PointSets, SurfaceHasTheSkinsArea) {
    const Model model = lattice_with_skin();
    const PointSet set = point_set(model, fem::ActsOn::surface);
    EXPECT_EQ(set.at.size(), model.skin.size());
    EXPECT_NEAR(set.weights.sum(), mesh::area(model.surface), 1e-9);
}

TEST(PointSets, SupportIsItsSkinOnTheNearestHeldSpheres) {
    const Model model = lattice_with_skin();
    const PointSet set = point_set(model, fem::ActsOn::support);
    EXPECT_NEAR(set.weights.sum(), 1, 1e-14);
    EXPECT_EQ(set.at.size(), 25u);  // 5 x 5 vertices of one side: some for each of the four spheres, not in line
    for (const Attachment& point : set.at) {
        EXPECT_EQ(point.rest.x(), -4);
        ASSERT_EQ(point.shares.size(), 1);
        ASSERT_TRUE(model.spheres[point.shares[0].sphere].held);
        for (const Sphere& sphere : model.spheres) {
            if (!sphere.held) continue;
            EXPECT_LE((model.spheres[point.shares[0].sphere].center - point.rest).norm(),
                      (sphere.center - point.rest).norm());
        }
    }
}

TEST(PointSets, AHeldSphereThatItsSkinDoesNotKeepFromTurningBearsSixPointsMore) {
    Model model = lattice_with_skin();
    const auto extent = [&] {
        const PointSet set = point_set(model, fem::ActsOn::support);
        int on_axes = 0;
        for (const Attachment& point : set.at)
            on_axes += std::abs((point.rest - model.spheres[point.shares[0].sphere].center).norm() - 4) < 1e-12;
        EXPECT_NEAR(set.weights.sum(), 1, 1e-14);
        return on_axes;
    };
    EXPECT_EQ(extent(), 0);
    model.supports = {mesh::SphereRegion{{-4, -4, -4}, 1}};  // one corner, on one of four held spheres
    EXPECT_EQ(extent(), 4 * 6);
    model.supports = {};
    EXPECT_EQ(extent(), 4 * 6);
}

TEST(PointSets, AHeldSphereWithoutLinksBearsNothingAndStays) {
    Model model = make_chain(2);
    model.spheres.push_back(testing::sphere_at({0, 30, 0}, true));
    for (const Attachment& point : point_set(model, fem::ActsOn::support).at) EXPECT_EQ(point.shares[0].sphere, 0);
    const Equilibrium found = equilibrium(with_effects(model, {compliant_support(1)}), force_at(model, 2, {1, 0, 0}));
    EXPECT_NEAR(found.step[0], 1, 1e-8);
    EXPECT_EQ(found.step.segment<6>(18).norm(), 0);
}

}  // namespace
}  // namespace palpate::skeleton
