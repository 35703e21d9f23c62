#include <gtest/gtest.h>

#include "skeleton/effects/placed_effects.h"
#include "skeleton/loads/cavities.h"
#include "skeleton/loads/cavity_walls.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/messages.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using testing::force_at;
using testing::lattice_with_skin;
using testing::make_chain;
using testing::random_state;
using testing::with_cavity;
using testing::with_law;

Model hollow() { return with_cavity(lattice_with_skin(), {15, 5, 5}, 4); }

TEST(Cavities, AreTheClosedPartsThatAreTurnedInwards) {
    const Model model = hollow();
    const double ball = mesh::signed_volume(mesh::make_sphere({15, 5, 5}, 4, 1));
    EXPECT_NEAR(Cavities(model).volume(rest_state(model)), ball, 1e-12);
    EXPECT_TRUE(Cavities(lattice_with_skin()).empty());
    EXPECT_TRUE(Cavities(make_chain(2)).empty());

    Model open = model;  // one triangle of the wall is missing
    open.surface.triangles.conservativeResize(open.surface.triangles.rows() - 1, 3);
    EXPECT_TRUE(Cavities(open).empty());
    const Model two = with_cavity(model, {5, 5, 5}, 2);
    EXPECT_NEAR(Cavities(two).volume(rest_state(two)), ball * 9 / 8, 1e-12);
}

TEST(Cavities, HaveWallsOfTheirOwn) {
    const Model one = hollow(), two = with_cavity(one, {5, 5, 5}, 2);
    EXPECT_EQ(walls_by_cavity(one).size(), 1U);
    const std::vector<CavityWall> walls = walls_by_cavity(two);
    ASSERT_EQ(walls.size(), 2U);
    EXPECT_EQ(find_cavity(two, walls, {Vec3(15, 5, 5)}), 0);
    EXPECT_EQ(find_cavity(two, walls, {Vec3(5, 5, 5)}), 1);
    EXPECT_EQ(find_cavity(two, walls, {mesh::make_sphere({5, 5, 5}, 2, 1)}), 1);
    EXPECT_EQ(find_cavity(make_chain(2), walls_by_cavity(make_chain(2)), {Vec3(5, 5, 5)}), -1);
}

TEST(Cavities, GradientIsTheVolumesDerivative) {
    const Model model = hollow();
    const Cavities cavities(model);
    std::mt19937_64 engine(5);
    const State state = random_state(model, engine, 2, 0.6);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(model.dofs());
    cavities.add_gradient(state, 2, gradient);
    const double h = 1e-5;
    for (int j = 0; j < model.dofs(); ++j) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.dofs(), j);
        const double slope = (cavities.volume(advance(state, step)) - cavities.volume(advance(state, -step))) / (2 * h);
        EXPECT_NEAR(gradient[j], 2 * slope, 1e-6) << j;  // h^2 times third derivatives of 1e3; rounding of 1e3 over h
    }
}

TEST(PressureEffect, ActsInTheCavityThatItIsToldOf) {
    // Two hollows in one skin: a point and a surface find each, and both together are the body's.
    const Model one = hollow();
    const Model two = testing::with_cavity(one, {5, 5, 5}, 2);
    const mesh::PressureActuator left{Vec3(4, 5, 5)}, right{mesh::make_sphere({15, 5, 5}, 4, 1)};
    const double whole = Cavities(two).rest_volume(), first = Cavities(two, left).rest_volume(),
                 second = Cavities(two, right).rest_volume();
    EXPECT_NEAR(second, Cavities(one).rest_volume(), 1e-12 * whole);  // rounding
    EXPECT_NEAR(first + second, whole, 1e-12 * whole);
    EXPECT_NEAR(first, second / 8, 1e-12 * whole);  // of half the radius
}

TEST(PressureEffect, ExertsNoNetForceNorTorque) {
    const Model model = hollow();
    std::mt19937_64 engine(6);
    const State state = random_state(model, engine, 2, 0.6);
    const Eigen::VectorXd f = effect_force(model, state, {.pressure = 0.1});
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        force += f.segment<3>(6 * i);
        torque += f.segment<3>(6 * i + 3) + Vec3(state.x.row(i)).cross(f.segment<3>(6 * i));
    }
    EXPECT_GT(f.norm(), 1);
    EXPECT_LT(force.norm(), 1e-14);  // rounding
    EXPECT_LT(torque.norm(), 1e-12);
}

TEST(PressureEffect, TurnsWithTheBody) {
    const Model model = hollow();
    const PlacedEffects effects(model, {.pressure = 0.1});
    std::mt19937_64 engine(7);
    const State state = random_state(model, engine, 2, 0.6);
    const Mat3 Q = rotation({1, -2, 0.5});
    State turned = state;
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
        turned.x.row(i) = (Q * state.x.row(i).transpose() + Vec3(10, -20, 5)).transpose();
        turned.R[i] = Q * state.R[i];
    }
    EXPECT_NEAR(effects.energy(turned).sum, effects.energy(state).sum, 1e-12);
}

TEST(PressureEffect, BlowsTheCavityUp) {
    const Model model = hollow();
    const Cavities cavities(model);
    double last = cavities.volume(rest_state(model));
    for (const double pressure : {0.02, 0.05, 0.1}) {
        const Equilibrium found = StaticsSolver(model, {.pressure = pressure}).solve(stiffness_vector(model), {});
        const double volume = cavities.volume(found.state);
        EXPECT_GT(volume, last);
        last = volume;
    }
}

TEST(PressureEffect, IsADeadLoadByTheLinearLaw) {
    const Model model = with_law(hollow(), EquilibriumLaw::linear);
    const Eigen::VectorXd k = stiffness_vector(model);
    const Eigen::VectorXd once = StaticsSolver(model, {.pressure = 0.1}).solve(k, {}).step;
    EXPECT_GT(once.norm(), 1e-2);
    EXPECT_LT((StaticsSolver(model, {.pressure = 0.2}).solve(k, {}).step - 2 * once).norm(), 1e-12 * once.norm());
    const Eigen::VectorXd f = effect_force(model, rest_state(model), {.pressure = 0.1});
    EXPECT_LT((StaticsSolver(model).linear_steps(k, f).col(0) - once).norm(), 1e-12 * once.norm());
}

TEST(KnownPressure, ActsAsTheEffectDoes) {
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Model model = with_law(hollow(), law);
        const Eigen::VectorXd k = stiffness_vector(model);
        Load load = force_at(model, 3, {0.1, 0.2, -0.3});
        const State by_effect = StaticsSolver(model, {.pressure = 0.05}).solve(k, load).state;
        load.pressure = 0.05;
        load.cavities = std::make_shared<const Cavities>(model);
        const State by_load = StaticsSolver(model).solve(k, load).state;
        EXPECT_GT((by_effect.x - rest_state(model).x).norm(), 1e-2);
        EXPECT_LT((by_load.x - by_effect.x).norm(), 1e-9);
    }
}

TEST(KnownPressure, HasTheEffectsTangent) {
    const Model model = hollow();
    std::mt19937_64 engine(8);
    const State state = random_state(model, engine, 2, 0.6);
    Load load;
    load.pressure = 0.05;
    load.cavities = std::make_shared<const Cavities>(model);
    const Eigen::SparseMatrix<double> by_effect = tangent(model, state, {}, {.pressure = 0.05});
    EXPECT_LT((tangent(model, state, load) - by_effect).norm(), 1e-12 * by_effect.norm());
    EXPECT_NEAR(potential(model, state, load), potential(model, state, {}, {.pressure = 0.05}), 1e-10);
}

TEST(PressureEffect, NeedsACavity) {
    EXPECT_EQ(
        message_of([] { StaticsSolver(lattice_with_skin(), {.pressure = 0.1}); }),
        "the model's skin encloses no cavity, in which a pressure could act: give it one, closed and turned inwards, "
        "or take the pressure away");
}

}  // namespace
}  // namespace palpate::skeleton
