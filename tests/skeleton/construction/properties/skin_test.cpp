#include "skeleton/construction/properties/skin.h"

#include <gtest/gtest.h>

#include <numbers>

#include "mesh/core/volume_mesh.h"
#include "skeleton/construction/build.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

// A limb of 160 x 16 x 16 mm, held at its low end, as a chain.
const Model& bar_limb() {
    static const Model model = [] {
        const mesh::VolumeMesh body = mesh::make_bar({0, 0, 0}, {160, 16, 16}, {40, 4, 4});
        return build_skeleton(mesh::boundary_surface(body), body, {}, {mesh::PlaneRegion{{0, 0, 0}, {1, 0, 0}, 1e-3}},
                              {.spheres = 14});
    }();
    return model;
}

// The chain's axis laid on a curve: where the material at x of the axis goes, and how it turns.
template <typename Curve>
Points skin_along(const Curve& curve) {
    State state = rest_state(bar_limb());
    for (std::size_t i = 0; i < bar_limb().spheres.size(); ++i) {
        const Vec3 X = bar_limb().spheres[i].center;
        const auto [at, R] = curve(X.x());
        state.x.row(static_cast<Eigen::Index>(i)) = (at + R * Vec3(0, X.y() - 8, X.z() - 8)).transpose();
        state.R[i] = R;
    }
    return observe(bar_limb(), state, bar_limb().skin);
}

TEST(MakeSkin, FollowsRigidMotionsExactly) {
    const Mat3 R = rotation({0.3, -1.1, 2.0});
    const Points moved = skin_along([&](double x) { return std::pair(Vec3(R * Vec3(x, 0, 0)), R); });
    const Points expected = (bar_limb().surface.vertices.rowwise() - Eigen::RowVector3d(0, 8, 8)) * R.transpose();
    EXPECT_LT((moved - expected).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(MakeSkin, WhatASupportHoldsStays) {
    Model pulled = bar_limb();
    pulled.law = EquilibriumLaw::linear;
    const Equilibrium found = equilibrium(pulled, testing::force_at(pulled, 14, {0.01, 0.02, 0}));
    const Points moved = observe(pulled, found, pulled.skin) - pulled.surface.vertices;
    for (Eigen::Index v = 0; v < moved.rows(); ++v) {
        if (pulled.surface.vertices(v, 0) > 1e-3) continue;
        EXPECT_LT(moved.row(v).norm(), 1e-12);
    }
}

TEST(MakeSkin, GetsThinnerWhereItIsPulled) {
    Model pulled = bar_limb();
    pulled.law = EquilibriumLaw::linear;
    const fem::Material material;
    const double force = 0.1;
    Load load;
    load.forces.push_back({attach(pulled, {160, 8, 8}), {force, 0, 0}});
    const Points moved = observe(pulled, equilibrium(pulled, load), pulled.skin) - pulled.surface.vertices;
    const double strain = force / (material.young * 256), inward = material.poisson * strain * 8;
    int seen = 0;
    for (Eigen::Index v = 0; v < moved.rows(); ++v) {
        const Vec3 X = pulled.surface.vertices.row(v);
        if (std::abs(X.x() - 80) > 25 || X.y() < 15.9) continue;
        EXPECT_NEAR(moved(v, 1), -inward, 0.012 * inward);  // shares of spheres beside it take 1 %
        EXPECT_NEAR(moved(v, 0), strain * X.x(), 1e-3 * strain * 160);
        ++seen;
    }
    EXPECT_GT(seen, 20);
}

TEST(MakeSkin, BendsAsAnArcWithoutCreases) {
    const double radius = 160 / (std::numbers::pi / 2);  // a quarter of a circle
    const Points bent = skin_along([&](double x) {
        const double angle = x / radius;
        return std::pair(Vec3(radius * std::sin(angle), radius * (1 - std::cos(angle)), 0),
                         Mat3(rotation(angle * Vec3::UnitZ())));
    });
    for (Eigen::Index v = 0; v < bent.rows(); ++v) {
        const Vec3 X = bar_limb().surface.vertices.row(v);
        if (X.x() < 1e-3) continue;  // held
        const double angle = X.x() / radius, r = radius - (X.y() - 8);
        const Vec3 exact(r * std::sin(angle), radius - r * std::cos(angle), X.z() - 8);
        EXPECT_LT((bent.row(v).transpose() - exact).norm(), 0.6) << X.transpose();  // of a thickness of 16 mm
    }
}

TEST(MakeSkin, TwistsWithoutPinching) {
    const Points twisted = skin_along(
        [&](double x) { return std::pair(Vec3(x, 0, 0), Mat3(rotation(x / 160 * std::numbers::pi * Vec3::UnitX()))); });
    for (Eigen::Index v = 0; v < twisted.rows(); ++v) {
        const Vec3 X = bar_limb().surface.vertices.row(v);
        const double before = std::hypot(X.y() - 8, X.z() - 8), after = twisted.row(v).tail<2>().norm();
        EXPECT_NEAR(after, before, 0.05) << X.transpose();  // of a half thickness of 8 mm
    }
}

}  // namespace
}  // namespace palpate::skeleton
