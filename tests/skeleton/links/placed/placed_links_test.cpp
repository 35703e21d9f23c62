#include "skeleton/links/placed/placed_links.h"

#include <gtest/gtest.h>

#include "fem/effects/material/anisotropy.h"
#include "fem/effects/material/inclusion.h"
#include "fem/effects/material/prestress.h"
#include "fem/effects/material/stiffening.h"
#include "skeleton/effects/link_effects.h"
#include "skeleton/statics/statics.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using fem::Anisotropy;
using fem::Fibre;
using fem::Inclusion;
using fem::Prestress;
using fem::Stiffening;
using testing::make_lattice;
using testing::random_state;
using testing::random_vector;

Mat3 some_stress() {
    Mat3 S;
    S << 0.2, 0.05, -0.1, 0.05, -0.3, 0.02, -0.1, 0.02, 0.15;
    return S;
}

struct Tested {
    std::string name;
    fem::Effects effects;
};

// Links of a lattice, as of rods of 4 mm radius, with one effect or several.
class LinksWith : public ::testing::TestWithParam<Tested> {
protected:
    LinksWith() {
        for (Link& link : model.links) link.gyration = 2;
        if (GetParam().effects.remember()) before = links.flowed(random_state(model, engine, 2, 0.3));
    }
    size_t size() const { return model.links.size(); }
    // A state after a step of one link's two ends.
    State moved(const State& state, size_t l, const Vec12& ends) const {
        Eigen::VectorXd step = Eigen::VectorXd::Zero(model.dofs());
        step.segment<6>(6 * model.links[l].a) = ends.head<6>();
        step.segment<6>(6 * model.links[l].b) = ends.tail<6>();
        return advance(state, step);
    }

    std::mt19937_64 engine{11};
    Model model = make_lattice({3, 2, 2});
    PlacedLinks links{with_gyration(model), GetParam().effects};
    FibreStates before;

private:
    static Model with_gyration(Model model) {
        for (Link& link : model.links) link.gyration = 2;
        return model;
    }
};

TEST_P(LinksWith, GradientIsTheEnergysDerivative) {
    const State state = random_state(model, engine, 2, 0.3);
    const double h = 1e-5;
    for (size_t l = 0; l < size(); ++l) {
        const LinkTerms terms = links.terms(l, state, false, before);
        for (int j = 0; j < 12; ++j) {
            const Vec12 step = h * Vec12::Unit(j);
            const Vec3 difference = (links.terms(l, moved(state, l, step), false, before).energy -
                                     links.terms(l, moved(state, l, -step), false, before).energy) /
                                    (2 * h);
            // h^2 times third derivatives of order 1e4, and rounding of energies of 1e3 over h.
            EXPECT_LT((difference - terms.gradient.row(j).transpose()).norm(), 2e-6) << l;
        }
    }
}

// As of link_terms, differences of the gradient see turned frames; symmetric parts agree.
TEST_P(LinksWith, HessianIsTheGradientsDerivative) {
    const State state = random_state(model, engine, 2, 0.3);
    const double h = 1e-5;
    for (size_t l = 0; l < size(); ++l) {
        const LinkTerms terms = links.terms(l, state, true, before);
        std::array<Mat12, 3> D;
        for (int j = 0; j < 12; ++j) {
            const Vec12 step = h * Vec12::Unit(j);
            const auto difference = (links.terms(l, moved(state, l, step), false, before).gradient -
                                     links.terms(l, moved(state, l, -step), false, before).gradient)
                                        .eval();
            for (int s = 0; s < 3; ++s) D[s].col(j) = difference.col(s) / (2 * h);
        }
        for (int s = 0; s < 3; ++s) {
            const double size = terms.hessian[s].norm();
            EXPECT_LT((terms.hessian[s] - terms.hessian[s].transpose()).norm(), 1e-13 * size);
            EXPECT_LT((terms.hessian[s] - 0.5 * (D[s] + D[s].transpose())).norm(), 1e-7 * size) << stiffness_names[s];
        }
    }
}

TEST_P(LinksWith, WeightedHessianIsTheSum) {
    const State state = random_state(model, engine, 2, 0.3);
    const Vec3 k(2, 300, 50);
    for (size_t l = 0; l < size(); ++l) {
        const LinkTerms terms = links.terms(l, state, true, before);
        const Mat12 sum = k[0] * terms.hessian[0] + k[1] * terms.hessian[1] + k[2] * terms.hessian[2];
        EXPECT_LT((links.hessian(l, k, pose(model.links[l], state), before) - sum).norm(),
                  1e-13 * sum.norm());  // rounding
    }
}

TEST_P(LinksWith, NetForceAndTorqueAreZero) {
    const State state = random_state(model, engine, 2, 0.3);
    for (size_t l = 0; l < size(); ++l) {
        const LinkTerms terms = links.terms(l, state, false, before);
        const Vec3 x_a = state.x.row(model.links[l].a), x_b = state.x.row(model.links[l].b);
        for (int s = 0; s < 3; ++s) {
            const Vec12 g = terms.gradient.col(s);
            const Vec3 torque =
                g.segment<3>(3) + g.segment<3>(9) + x_a.cross(g.segment<3>(0)) + x_b.cross(g.segment<3>(6));
            // Rounding, on arms of 30 mm.
            EXPECT_LT((g.segment<3>(0) + g.segment<3>(6)).norm(), 1e-15 * g.norm());
            EXPECT_LT(torque.norm(), 1e-13 * g.norm());
        }
    }
}

TEST_P(LinksWith, EnergyIsTheSameAfterARigidMotion) {
    const State state = random_state(model, engine, 2, 0.3);
    const Mat3 Q = rotation({1, -2, 0.5});
    State turned = state;
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
        turned.x.row(i) = (Q * state.x.row(i).transpose() + Vec3(10, -20, 5)).transpose();
        turned.R[i] = Q * state.R[i];
    }
    for (size_t l = 0; l < size(); ++l) {
        const Vec3 energy = links.terms(l, state, false, before).energy;
        const Vec3 after = links.terms(l, turned, false, before).energy;
        EXPECT_LT((after - energy).norm(), 1e-12 * (1 + energy.norm()));  // rounding
    }
}

TEST_P(LinksWith, NothingButPrestressAndFlowPullsAtRest) {
    // The material's effects are in order at rest but for these.
    const bool pulls = GetParam().name == "Prestress" || GetParam().name == "All";
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(3 * static_cast<Eigen::Index>(size()));
    double most = 0;
    for (size_t l = 0; l < size(); ++l) most = std::max(most, links.terms(l, rest_state(model), false).gradient.norm());
    if (pulls) {
        EXPECT_GT(most, 0.1);
        EXPECT_GT(links.largest_rest_force(ones), 0.1);
    } else {
        EXPECT_LT(most, 1e-13);  // rounding of lengths of 10 mm
        EXPECT_LT(links.largest_rest_force(ones), 1e-13);
    }
}

TEST_P(LinksWith, LinearForcesAreTheFirstOrderOfForces) {
    const Eigen::VectorXd direction = Eigen::VectorXd::LinSpaced(model.dofs(), -1, 1).array().sin();
    const auto left = [&](double h) {
        const Eigen::VectorXd step = h * direction;
        const State state = advance(rest_state(model), step);
        return (Eigen::MatrixXd(links.forces(state)) - Eigen::MatrixXd(links.linear_forces(step))).norm();
    };
    EXPECT_GT(left(1e-2), 0);
    EXPECT_NEAR(left(1e-2) / left(5e-3), 4, 0.01);  // of second order; the third is 1e-2 / 2 of it at most
}

const auto stiffening = std::make_shared<Stiffening>(0.5, 2);
const auto fibres = std::make_shared<Anisotropy>(std::vector<Fibre>{{3, {1, 1, 0.5}}, {1, {0, 1, -1}}});
const auto prestress = std::make_shared<Prestress>(some_stress());
const auto inclusion = std::make_shared<Inclusion>(Inclusion::sphere({10, 5, 5}, 8, 5));

INSTANTIATE_TEST_SUITE_P(Effects, LinksWith,
                         ::testing::Values(Tested{"None", {}}, Tested{"Stiffening", {.material = {stiffening}}},
                                           Tested{"Anisotropy", {.material = {fibres}}},
                                           Tested{"Prestress", {.material = {prestress}}},
                                           Tested{"Inclusion", {.material = {inclusion}}},
                                           Tested{"Plasticity", {.plasticity = fem::Plasticity{0.02, 0.3}}},
                                           Tested{"Damage", {.damage = fem::Damage{0.6, 0.05}}},
                                           Tested{"Torsion", {.of_model = {in_links({.torsion = 0.7})}}},
                                           Tested{"Shear", {.of_model = {in_links({.shear = 0.4})}}},
                                           Tested{"All",
                                                  {.material = {stiffening, fibres, prestress, inclusion},
                                                   .plasticity = fem::Plasticity{0.02, 0.3},
                                                   .damage = fem::Damage{0.6, 0.05},
                                                   .of_model = {in_links({.torsion = 0.7, .shear = 0.4})}}}),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace palpate::skeleton
