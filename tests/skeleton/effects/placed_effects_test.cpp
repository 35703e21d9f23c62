#include <gtest/gtest.h>

#include "fem/effects/material/anisotropy.h"
#include "fem/effects/material/inclusion.h"
#include "fem/effects/material/prestress.h"
#include "fem/effects/material/stiffening.h"
#include "skeleton/effects/link_effects.h"
#include "skeleton/effects/placed_effects.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/messages.h"
#include "tests/skeleton/test_effects.h"
#include "tests/surface_energies.h"

namespace palpate::skeleton {
namespace {

using fem::Anisotropy;
using fem::Fibre;
using fem::Inclusion;
using fem::Prestress;
using fem::Stiffening;
using testing::compliant_support;
using testing::force_at;
using testing::gravity;
using testing::lattice_with_skin;
using testing::make_lattice;
using testing::random_state;
using testing::Slope;
using testing::with_cavity;
using testing::with_effects;
using testing::with_law;

// With links as of rods of 4 mm radius.
Model slender(Model model) {
    for (Link& link : model.links) link.gyration = 2;
    return model;
}

Model hollow_lattice() { return with_cavity(lattice_with_skin(), {15, 5, 5}, 4); }

// All of what a model is under: its own effects and one that no file knows.
struct InForce {
    std::string name;
    std::vector<EffectRecord> effects;
    fem::Effects extra;
};

class EachEffect : public ::testing::TestWithParam<InForce> {
protected:
    const Model model = with_effects(slender(hollow_lattice()), GetParam().effects);
    const fem::Effects& extra = GetParam().extra;
    Load load = force_at(model, 3, {1, 2, -3});

    double energy(const State& state) const { return potential(model, state, load, extra); }
    Eigen::VectorXd net(const State& state) const { return residual(model, state, load, extra); }
    Eigen::MatrixXd whole_tangent(const State& state) const { return tangent(model, state, load, extra); }
    bool is_free(int sphere) const {
        return !model.spheres[sphere].held || fem::release_supports(physics_of(model.effects)) ||
               fem::release_supports(extra);
    }
};

TEST_P(EachEffect, ForceIsMinusTheEnergysDerivative) {
    std::mt19937_64 engine(7);
    const State state = random_state(model, engine, 2, 0.6);
    const Eigen::VectorXd r = net(state);
    const double h = 1e-5;
    for (int j = 0; j < model.dofs(); ++j) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.dofs(), j);
        const double slope = (energy(advance(state, step)) - energy(advance(state, -step))) / (2 * h);
        // Rounding of an energy of some 1e4 over h is 1e-7; h^2 times third derivatives of 1e4 as much.
        EXPECT_NEAR(r[j], -slope, 3e-6) << j;
    }
}

TEST_P(EachEffect, TangentIsTheForcesDerivative) {
    std::mt19937_64 engine(8);
    const State state = random_state(model, engine, 2, 0.6);
    const Eigen::MatrixXd J = whole_tangent(state);
    Eigen::MatrixXd D(model.dofs(), model.dofs());
    const double h = 1e-5;
    for (int j = 0; j < model.dofs(); ++j) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.dofs(), j);
        D.col(j) = (net(advance(state, -step)) - net(advance(state, step))) / (2 * h);
    }
    EXPECT_LT((J - J.transpose()).norm(), 1e-13 * J.norm());  // rounding
    // Differences of torques see turned frames: their symmetric part is the derivative in exponential coordinates.
    EXPECT_LT((J - 0.5 * (D + D.transpose())).norm(), 1e-8 * J.norm());
}

TEST_P(EachEffect, EquilibriumBalancesAllForces) {
    StaticsSolver solver(model, extra);
    const Equilibrium found = solver.solve(stiffness_vector(model), load);
    const Eigen::VectorXd r = net(found.state);
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (is_free(i))
            EXPECT_LT(r.segment<6>(6 * i).norm(), 1e-6) << i;  // 1e-9 of loads of some 10 N, over 10 mm
        else
            EXPECT_EQ(found.step.segment<6>(6 * i).norm(), 0);
    }
    EXPECT_LT(energy(found.state), energy(rest_state(model)));
}

TEST_P(EachEffect, SolverFactorsTheWholeTangent) {
    StaticsSolver solver(model, extra);
    const Equilibrium found = solver.solve(stiffness_vector(model), load);
    Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(model.dofs(), -1, 1);
    const Eigen::VectorXd x = solver.solve_tangent(b);
    const Eigen::VectorXd left = whole_tangent(found.state) * x - b;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (is_free(i))
            EXPECT_LT(left.segment<6>(6 * i).norm(), 1e-9) << i;  // rounding, condition of some 1e5
        else
            EXPECT_EQ(x.segment<6>(6 * i).norm(), 0);
    }
}

TEST_P(EachEffect, LinearLawIsLinearInTheLoad) {
    const Model linear = with_law(model, EquilibriumLaw::linear);
    StaticsSolver solver(linear, extra);
    const Eigen::VectorXd k = stiffness_vector(model);
    const Equilibrium unloaded = solver.solve(k, {}), once = solver.solve(k, load);
    Load tenfold = load;
    tenfold.forces[0].force *= 10;
    const Equilibrium ten = solver.solve(k, tenfold);
    const Eigen::VectorXd moved = once.step - unloaded.step;
    EXPECT_GT(moved.norm(), 1e-2);
    EXPECT_LT((ten.step - unloaded.step - 10 * moved).norm(), 1e-10 * ten.step.norm());  // rounding
    EXPECT_LT(ten.residual, 1e-9);

    // Steps under forces alone are what loads add to the effects' own.
    const Eigen::MatrixXd F = external_force(model, rest_state(model), load);
    EXPECT_LT((solver.linear_steps(k, F).col(0) - moved).norm(), 1e-10 * moved.norm());
}

// d observe / d k = P J^-1 G, against differences of whole equilibria, for both laws.
TEST_P(EachEffect, TangentGivesTheSensitivityToStiffness) {
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Model tested = with_law(model, law);
        StaticsSolver solver(tested, extra);
        const Eigen::VectorXd k = stiffness_vector(tested);
        const Equilibrium found = solver.solve(k, load, {1e-12});
        const Eigen::MatrixXd A = observation_jacobian(tested, found, tested.skin) *
                                  solver.solve_tangent(Eigen::MatrixXd(link_forces(tested, found, extra)));
        for (const int e : {0, 4, 11, 30, 40, 47}) {
            const double h = 1e-4 * k[e];
            const Eigen::VectorXd change = h * Eigen::VectorXd::Unit(k.size(), e);
            const Points difference = observe(tested, solver.solve(k + change, load, {1e-12}), tested.skin) -
                                      observe(tested, solver.solve(k - change, load, {1e-12}), tested.skin);
            const Eigen::Map<const Eigen::VectorXd> flat(difference.data(), difference.size());
            // Relative h^2 = 1e-8; equilibria known to 1e-12 of 4 N, over h.
            EXPECT_LT((flat / (2 * h) - A.col(e)).norm(), 1e-6 * A.col(e).norm() + 1e-7) << law_names[int(law)] << e;
        }
    }
}

TEST_P(EachEffect, NewtonSquaresItsError) {
    // The last steps: seven digits more take two at most.
    const int rough = StaticsSolver(model, extra).solve(stiffness_vector(model), load, {1e-4}).iterations;
    const int fine = StaticsSolver(model, extra).solve(stiffness_vector(model), load, {1e-11}).iterations;
    EXPECT_LE(fine, rough + 2);
}

const auto slope = std::make_shared<Slope>(2e-3, 0.02);
const auto tension = std::make_shared<Tension>(0.05);
const auto area_spring = std::make_shared<AreaSpring>(0.05);
const auto stiffening = std::make_shared<Stiffening>(0.5, 2);
const auto fibres = std::make_shared<Anisotropy>(std::vector<Fibre>{{3, {1, 1, 0.5}}});
const auto prestress = std::make_shared<Prestress>(Vec3(0.05, -0.1, 0.02).asDiagonal());
const auto inclusion = std::make_shared<Inclusion>(Inclusion::sphere({15, 5, 5}, 8, 5));

std::shared_ptr<const mesh::TendonActuator> tendon(bool by_length) {
    Points path(3, 3);
    path << -2, 3, 8, 10, 4, 9, 19, 5, 6;
    return std::make_shared<mesh::TendonActuator>(mesh::TendonActuator{path, by_length});
}
const auto cavity = std::make_shared<mesh::PressureActuator>(mesh::PressureActuator{Vec3(15, 5, 5)});

INSTANTIATE_TEST_SUITE_P(
    Effects, EachEffect,
    ::testing::Values(
        InForce{"None", {}, {}}, InForce{"Gravity", {gravity({100, -2e5, 9e5})}, {}},
        InForce{"CompliantSupport", {compliant_support(8)}, {}}, InForce{"Skin", {}, {.points = {slope}}},
        InForce{"Stiffening", {}, {.material = {stiffening}}}, InForce{"Anisotropy", {}, {.material = {fibres}}},
        InForce{"Prestress", {}, {.material = {prestress}}}, InForce{"Inclusion", {}, {.material = {inclusion}}},
        InForce{"Swelling", {{"swelling", {{"growth", 0.04, ""}}}}, {}},
        InForce{"LocalSwelling",
                {{"local-swelling",
                  {{"cx", 10, ""}, {"cy", 8, ""}, {"cz", 5, ""}, {"radius", 9, ""}, {"growth", 0.06, ""}}}},
                {}},
        InForce{"Plasticity", {}, {.plasticity = fem::Plasticity{0.02, 0.3}}},
        InForce{"Damage", {}, {.damage = fem::Damage{0.6, 0.05}}},
        InForce{"TorsionAndShear", {}, {.of_model = {in_links({.torsion = 0.7, .shear = 0.4})}}},
        InForce{"Area", {}, {.surface = {tension, area_spring}}}, InForce{"Pressure", {}, {.pressure = 0.05}},
        InForce{"CavityPressure", {}, {.cavities = {{cavity, 0.05}}}},
        InForce{"Tendon", {}, {.tendons = {{tendon(false), 2, 0}}}},
        InForce{"Cable", {}, {.tendons = {{tendon(true), 4, 1e-3}}}},
        InForce{"All",
                {compliant_support(8), gravity({100, -2e5, 9e5}), {"outliers", {}}},
                {.points = {slope},
                 .material = {stiffening, fibres, prestress, inclusion},
                 .surface = {tension, area_spring},
                 .pressure = 0.05,
                 .plasticity = fem::Plasticity{0.02, 0.3},
                 .damage = fem::Damage{0.6, 0.05},
                 .of_model = {in_links({.torsion = 0.7, .shear = 0.4})}}}),
    [](const auto& tested) { return tested.param.name; });

TEST(SurfaceEnergy, CostsTheAreaOfTheSkin) {
    const Model model = lattice_with_skin();
    const State rest = rest_state(model);
    EXPECT_NEAR(PlacedEffects(model, {.surface = {tension}}).energy(rest).sum,
                0.05 * mesh::area_vectors(model.surface).rowwise().norm().sum(), 1e-10);  // rounding
}

TEST(SurfaceEnergy, NeedsASkin) {
    const Model bare = make_lattice({3, 2, 2});
    EXPECT_TRUE(says(message_of([&] { PlacedEffects(bare, {.surface = {tension}}); }), {"has no skin", "give it one"}));
}

TEST(EffectsByTheLinearLaw, AreTheLimitOfSmallDisplacements) {
    const Model model = with_effects(hollow_lattice(), {gravity({100, -2e5, 9e5})});
    const fem::Effects extra{
        .points = {slope}, .material = {stiffening, fibres}, .pressure = 0.05, .of_model = {in_links({.shear = 0.4})}};
    const Load load = force_at(model, 3, {1, 2, -3});
    const auto difference = [&](double times) {
        const Eigen::VectorXd k = times * stiffness_vector(model);
        const Eigen::VectorXd large = StaticsSolver(model, extra).solve(k, load, {1e-13}).step;
        const Eigen::VectorXd linear =
            StaticsSolver(with_law(model, EquilibriumLaw::linear), extra).solve(k, load).step;
        return (large - linear).norm() / linear.norm();
    };
    // The first term left out is of second order: twice the stiffness, half the relative difference.
    EXPECT_NEAR(difference(1e3) / difference(2e3), 2, 0.01);  // the next term takes 0.006
    EXPECT_LT(difference(1e3), 1.2e-4);
}

}  // namespace
}  // namespace palpate::skeleton
