#include "fem/effects/point/gravity.h"

#include <gtest/gtest.h>

#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using testing::force_at;
using testing::gravity;
using testing::make_chain;
using testing::make_lattice;
using testing::random_state;
using testing::with_effects;
using testing::with_law;

TEST(GravityEffect, IsTheSameAsAKnownOne) {
    const Vec3 g(300, -4e5, 5e5);
    const Model model = make_lattice({4, 2, 2}), heavy = with_effects(model, {gravity(g)});
    Load load = force_at(model, 3, {1, 2, -3}), with_weight = load;
    with_weight.gravity = g;
    std::mt19937_64 engine(3);
    const State state = random_state(model, engine, 2, 0.6);
    EXPECT_EQ(effect_force(heavy, state) + external_force(model, state, load),
              external_force(model, state, with_weight));
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Eigen::VectorXd step = equilibrium(with_law(heavy, law), load, {1e-12}).step;
        // Forces known to 1e-12 of 4 N over stiffnesses of 1 N/mm.
        EXPECT_LT((step - equilibrium(with_law(model, law), with_weight, {1e-12}).step).norm(), 1e-9);
    }
}

TEST(GravityEffect, IsAddedToAKnownOne) {
    const Model model = with_effects(make_chain(5, -Vec3::UnitZ()), {gravity({0, 0, -9810})});
    Load load;
    load.gravity = {0, 0, 9810};
    EXPECT_LT(equilibrium(model, load).step.norm(), 1e-12);
}

TEST(GravityEffect, HangsOnTheSupport) {
    const Model model = with_effects(make_lattice({5, 2, 2}), {gravity({0, 0, -9e5})});
    const Equilibrium found = equilibrium(model, {});  // nothing else: it must converge by itself
    EXPECT_LT(found.residual, 1e-8);
    const Eigen::VectorXd r = residual(model, found.state, {});
    Vec3 reaction = Vec3::Zero();
    double mass = 0;
    for (size_t i = 0; i < model.spheres.size(); ++i) {
        mass += model.spheres[i].mass;
        if (model.spheres[i].held) reaction -= r.segment<3>(6 * i);
    }
    EXPECT_LT((reaction - mass * Vec3(0, 0, 9e5)).norm(), 1e-7);  // 20 spheres, each known to 1e-9 of a newton
}

TEST(GravityEffect, IsPutOnStepByStepWhereItMust) {
    const Model model = with_effects(make_chain(20), {gravity({0, 0, -3e5})});
    const Equilibrium whole = equilibrium(model, {});
    const int few = whole.iterations - 1;  // too few for all of it at once
    const Equilibrium in_steps = equilibrium(model, {}, {1e-9, few});
    EXPECT_GT(in_steps.iterations, few);
    EXPECT_LT((in_steps.step - whole.step).norm(), 1e-4);  // 1e-9 of 0.3 N over the softness of a chain of 20
}

}  // namespace
}  // namespace palpate::skeleton
