#include "identify/loading/loads.h"

#include <gtest/gtest.h>

#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

skeleton::Model slab() {
    skeleton::Model model = make_lattice({3, 3, 1});
    model.surface = mesh::make_box({-10, -10, -10}, {90, 90, 10}, {4, 4, 1});
    return model;
}

Vec3 total_force(const skeleton::Load& load) {
    Vec3 sum = Vec3::Zero();
    for (const skeleton::PointForce& force : load.forces) sum += force.force;
    return sum;
}

TEST(ContactLoads, APatchCarriesTheForceEvenlyRoundItsPoint) {
    const skeleton::Model model = slab();
    const Vec3 point(40, 35, 10), force(1, -2, -3);
    const skeleton::Load load = ContactLoads(model)({{point, force, 12}});
    EXPECT_LT((total_force(load) - force).norm(), 1e-12);  // rounding
    ASSERT_EQ(load.forces.size(), 1U);
    EXPECT_LT((load.forces[0].at.rest - point).norm(), 0.5);  // pieces of a third of the radius, cut at the rim
    ASSERT_EQ(load.patch_forces.size(), 1U);
    EXPECT_EQ(load.patch_forces[0].force, force);
    EXPECT_LT((load.patch_forces[0].normal - Vec3::UnitZ()).norm(), 1e-9);
    double inertia = 0, shares = 0;
    for (const auto& [at, share] : load.patch_forces[0].patch) {
        EXPECT_LE((at - point).norm(), 12);
        EXPECT_DOUBLE_EQ(at.z(), 10);
        inertia += share * (at - point).squaredNorm();
        shares += share;
    }
    EXPECT_NEAR(shares, 1, 1e-12);
    EXPECT_NEAR(inertia, 12 * 12 / 2.0, 8);  // of a disc r^2 / 2, a tenth for the rim
}

TEST(ContactLoads, WithoutRadiusTheNearestPointOfTheSkinTakesIt) {
    const skeleton::Model model = slab();
    const skeleton::Load load = ContactLoads(model)({{Vec3(30, 20, 17), Vec3(0, 0, -1), 0}});
    ASSERT_EQ(load.forces.size(), 1U);
    EXPECT_LT((load.forces[0].at.rest - Vec3(30, 20, 10)).norm(), 1e-9);
}

TEST(ContactLoads, ARadiusThatReachesNoSkinActsAtTheNearestPoint) {
    const skeleton::Model model = slab();
    const skeleton::Load load = ContactLoads(model)({{Vec3(30, 20, 17), Vec3(0, 0, -1), 2}});
    ASSERT_EQ(load.forces.size(), 1U);
    EXPECT_LT((load.forces[0].at.rest - Vec3(30, 20, 10)).norm(), 1e-9);
}

TEST(ContactLoads, WithoutASkinTheForceActsWhereItIsTold) {
    const skeleton::Model model = make_lattice({3, 3, 1});
    const skeleton::Load load =
        ContactLoads(model)({{Vec3(40, 40, 0), Vec3(0, 0, -1), 5}, {Vec3::Zero(), Vec3::Zero(), 0}});
    ASSERT_EQ(load.forces.size(), 1U);
    EXPECT_EQ(load.forces[0].at.rest, Vec3(40, 40, 0));
}

TEST(ContactLoads, AStatesGravityGoesBeforeTheSets) {
    const skeleton::Model model = slab();
    MeasurementSet set;
    LoadState state;
    EXPECT_EQ(ContactLoads(model)(set, state).gravity, Vec3::Zero());
    set.gravity = Vec3(0, 0, -9810);
    EXPECT_EQ(ContactLoads(model)(set, state).gravity, Vec3(0, 0, -9810));
    state.gravity = Vec3(9810, 0, 0);
    EXPECT_EQ(ContactLoads(model)(set, state).gravity, Vec3(9810, 0, 0));
}

}  // namespace
}  // namespace palpate::identify
