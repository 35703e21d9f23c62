#include "skeleton/links/placed/placed_volumes.h"

#include <gtest/gtest.h>

#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::make_full_lattice;
using testing::random_state;

double energy(const Model& model, const State& state) {
    return PlacedVolumes(model, {}).energy(stiffness_vector(model), state);
}

TEST(PlacedVolumes, RigidMotionCostsNothing) {
    const Model model = make_full_lattice({3, 2, 2});
    State state = rest_state(model);
    const Mat3 R = rotation({0.4, -1.2, 0.7});
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) state.x.row(i) = (R * state.x.row(i).transpose()).transpose();
    for (Mat3& turn : state.R) turn = R;
    EXPECT_LT(energy(model, state), 1e-24);
}

TEST(PlacedVolumes, ForceIsMinusTheEnergysDerivative) {
    const Model model = make_full_lattice({3, 2, 2});
    std::mt19937_64 engine(5);
    const State state = random_state(model, engine, 1, 0.3);
    const Eigen::VectorXd f = PlacedVolumes(model, {}).force(stiffness_vector(model), state);
    const double h = 1e-5;
    for (int c = 0; c < model.dofs(); ++c) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.dofs(), c);
        const double numeric = (energy(model, advance(state, step)) - energy(model, advance(state, -step))) / (2 * h);
        EXPECT_NEAR(-f[c], numeric, 1e-6 * (1 + f.norm()));
    }
}

TEST(PlacedVolumes, TangentIsMinusTheResidualsDerivativeInEquilibrium) {
    const Model model = make_full_lattice({3, 2, 2});
    const Load load = testing::force_at(model, 11, {0.5, -0.4, 0.3});
    const Equilibrium found = equilibrium(model, load);
    const Eigen::MatrixXd J(tangent(model, found.state, load));
    EXPECT_LT((J - J.transpose()).norm(), 1e-10 * J.norm());
    const double h = 1e-5;
    for (int c = 0; c < model.dofs(); ++c) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.dofs(), c);
        const Eigen::VectorXd numeric =
            (residual(model, advance(found.state, -step), load) - residual(model, advance(found.state, step), load)) /
            (2 * h);
        for (int i = 0; i < model.dofs(); ++i) {
            if (model.spheres[i / 6].held) continue;
            EXPECT_NEAR(J(i, c), numeric[i], 2e-6 * J.norm());
        }
    }
}

TEST(PlacedVolumes, ResidualIsLinearInTheStiffnesses) {
    const Model model = make_full_lattice({3, 2, 2});
    std::mt19937_64 engine(6);
    const State state = random_state(model, engine, 1, 0.3);
    const Eigen::VectorXd by_signature = link_forces(model, state) * stiffness_vector(model);
    EXPECT_LT((by_signature - residual(model, state, {})).norm(), 1e-10 * by_signature.norm());
}

TEST(PlacedVolumes, LinearForcesAreTheTangentTimesTheStep) {
    Model model = make_full_lattice({3, 2, 2});
    model.law = EquilibriumLaw::linear;
    const Load load = testing::force_at(model, 11, {0.5, -0.4, 0.3});
    const Equilibrium found = equilibrium(model, load);
    EXPECT_LT(found.residual, 1e-10);
}

// What holds the volume together makes a body stiffer where it is squeezed from all sides only.
TEST(PlacedVolumes, CostWhatTheCellsSwellBy) {
    const Model model = make_full_lattice({4, 4, 4});
    State state = rest_state(model);
    state.x *= 1.01;
    double expected = 0;
    for (const Sphere& sphere : model.spheres) expected += 0.5 * sphere.volume * sphere.cell * 0.03 * 0.03;
    // the lattice's outer cells have no links to the outside, and its links are not all 10 mm long: an eighth more
    EXPECT_NEAR(energy(model, state), 1.124 * expected, 1e-3 * expected);
}

}  // namespace
}  // namespace palpate::skeleton
