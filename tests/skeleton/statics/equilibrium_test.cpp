#include "skeleton/statics/equilibrium.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/errors.h"
#include "tests/messages.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::at_sphere;
using testing::force_at;
using testing::make_chain;
using testing::make_lattice;
using testing::random_state;
using testing::random_vector;
using testing::sphere_at;
using testing::with_law;

// A couple on a sphere by two opposite forces on arms of 1 mm: m = arm x force, twice.
Load couple_at(const Model& model, int sphere, const Vec3& arm, const Vec3& force) {
    Load load;
    const Vec3 center = model.spheres[sphere].center;
    load.forces.push_back({on_sphere(model, sphere, center + arm), force});
    load.forces.push_back({on_sphere(model, sphere, center - arm), -force});
    return load;
}

double largest_distance(const Points& a, const Points& b) { return (a - b).rowwise().norm().maxCoeff(); }

// --- One link: closed forms ---------------------------------------------------------------------------------------

class OneLink : public ::testing::TestWithParam<EquilibriumLaw> {
protected:
    const Model model = with_law(make_chain(1), GetParam());  // L = 10, kE = 2, kF = 300, kT = 200
};

TEST_P(OneLink, PulledStretchesByForceOverStiffness) {
    const Equilibrium found = equilibrium(model, force_at(model, 1, {0.5, 0, 0}));
    EXPECT_NEAR(found.step[6], 0.25, 1e-10);  // F / kE; the tolerance over kE
}

TEST_P(OneLink, TwistedTurnsByCoupleOverStiffness) {
    // The forces stay while their arms turn: m = 2 r F cos(tau) in large rotation.
    const Equilibrium found = equilibrium(model, couple_at(model, 1, {0, 1, 0}, {0, 0, 20}));
    const double tau = found.step[9];
    EXPECT_NEAR(200 * tau, GetParam() == EquilibriumLaw::linear ? 40 : 40 * std::cos(tau), 1e-7);
}

TEST_P(OneLink, BentByACoupleTurnsItsTipTwiceAsFarAsItself) {
    // Both ends' angles are equal, psi and theta - psi, and kF (theta - psi) = m.
    const Equilibrium found = equilibrium(model, couple_at(model, 1, {1, 0, 0}, {0, 10, 0}));
    const double theta = found.step[11];
    EXPECT_NEAR(150 * theta, GetParam() == EquilibriumLaw::linear ? 20 : 20 * std::cos(theta), 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Laws, OneLink, ::testing::Values(EquilibriumLaw::linear, EquilibriumLaw::large_rotation));

TEST(OneLinkFarBent, ObeysItsTwoEquations) {
    const Model model = make_chain(1);
    const double F = 40;
    const Equilibrium found = equilibrium(model, force_at(model, 1, {0, F, 0}));
    const Vec3 tip = found.state.x.row(1).transpose();
    const double l = tip.norm(), psi = std::atan2(tip.y(), tip.x());
    EXPECT_GT(psi, 0.8);                                  // far indeed
    EXPECT_NEAR(2 * (l - 10), F * std::sin(psi), 1e-7);   // along the link
    EXPECT_NEAR(300 * psi, F * l * std::cos(psi), 1e-6);  // about the held end
    EXPECT_NEAR(found.step[11], psi, 1e-8);               // the tip is free to follow
}

TEST(HangingChain, EveryLinkCarriesTheWeightBelow) {
    const Model model = make_chain(5, -Vec3::UnitZ());
    Load load;
    load.gravity = {0, 0, -9810};
    const Equilibrium found = equilibrium(model, load);
    const double weight = 1e-6 * 9810;
    for (int i = 0; i < 5; ++i) {
        const double stretch = -(found.step[6 * (i + 1) + 2] - found.step[6 * i + 2]);
        EXPECT_NEAR(stretch, (5 - i) * weight / 2.0, 1e-10);  // the tolerance over kE
    }
}

// --- Laws of both laws --------------------------------------------------------------------------------------------

TEST(Equilibrium, LinearIsTheLimitOfSmallLoads) {
    const Model model = make_chain(6);
    const auto difference = [&](double F) {
        const Load load = force_at(model, 6, {F, F, -F});
        const Eigen::VectorXd linear = equilibrium(with_law(model, EquilibriumLaw::linear), load).step;
        return (equilibrium(model, load, {1e-12}).step - linear).norm() / linear.norm();
    };
    // The first term left out is of second order: half the load, half the relative difference.
    EXPECT_NEAR(difference(1e-4) / difference(5e-5), 2, 1e-3);  // the next term: 1e-4, as the difference itself
    EXPECT_LT(difference(1e-4), 1.1e-4);
}

TEST(Equilibrium, LinearLawIsLinearInTheLoadAsItIsSeen) {
    const Model model = with_law(make_lattice({4, 3, 2}), EquilibriumLaw::linear);
    const std::vector<Attachment> points{between(model, 3, 7, 0.4, {31, 6, 2}), on_sphere(model, 11, {35, 22, -4})};
    const Points rest = observe(model, rest_state(model), points);
    const auto moved = [&](double F) -> Points {
        return observe(model, equilibrium(model, force_at(model, 3, {F, -F, 2 * F})), points) - rest;
    };
    EXPECT_GT(moved(1).norm(), 0.1);
    EXPECT_LT((moved(100) - 100 * moved(1)).norm(), 1e-11 * moved(100).norm());  // rounding of positions
}

TEST(Equilibrium, LowersThePotentialAndBalancesTheForces) {
    std::mt19937_64 engine(11);
    for (int i = 0; i < 10; ++i) {
        const Model model = make_lattice({5, 2, 2}, static_cast<std::uint64_t>(i));
        Load load = force_at(model, 4, random_vector(engine, 5));
        load.forces.push_back({between(model, 9, 14, 0.5, {40, 20, 5}), random_vector(engine, 5)});
        load.gravity = random_vector(engine, 9810);
        const Equilibrium found = equilibrium(model, load);
        EXPECT_LT(potential(model, found.state, load), potential(model, rest_state(model), load));
        const Eigen::VectorXd r = residual(model, found.state, load);
        double left = 0;
        for (int s = 0; s < static_cast<int>(model.spheres.size()); ++s)
            if (!model.spheres[s].held) left = std::max(left, r.segment<3>(6 * s).norm());
        EXPECT_LE(left, found.residual * (1 + 1e-6) + 1e-12);
        EXPECT_LT(found.residual, 1e-9 * external_force(model, found.state, load).norm());
        for (int s = 0; s < static_cast<int>(model.spheres.size()); ++s)
            if (model.spheres[s].held) {
                EXPECT_EQ(found.step.segment<6>(6 * s).norm(), 0);
            }
    }
}

TEST(Equilibrium, DoesNotDependOnTheStartNorTheLoadsPath) {
    const Model model = make_lattice({5, 2, 2});
    const Load load = force_at(model, 4, {2, -3, 4});
    const Equilibrium direct = equilibrium(model, load);

    std::mt19937_64 engine(12);
    State start = random_state(model, engine, 2, 0.3);
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i)
        if (model.spheres[i].held) {
            start.x.row(i) = model.spheres[i].center.transpose();
            start.R[i].setIdentity();
        }
    // Forces known to 1e-9 of 5 N over stiffnesses of 1 N/mm.
    EXPECT_LT(largest_distance(equilibrium(model, load, {}, &start).state.x, direct.state.x), 1e-7);

    const Equilibrium detour = equilibrium(model, force_at(model, 4, {-4, 4, 4}));
    EXPECT_LT(largest_distance(equilibrium(model, load, {}, &detour.state).state.x, direct.state.x), 1e-7);
}

TEST(Equilibrium, TurnsWithTheWholeProblem) {
    const Mat3 R = rotation({1, -2, 0.5});
    const Model model = make_lattice({4, 2, 2});
    Model turned = model;
    for (Sphere& sphere : turned.spheres) sphere.center = R * sphere.center;
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        Load load = force_at(model, 3, {1, 2, -3});
        load.gravity = {100, 9000, 0};
        Load load_turned = force_at(turned, 3, R * Vec3(1, 2, -3));
        load_turned.gravity = R * load.gravity;
        const Eigen::VectorXd step = equilibrium(with_law(model, law), load).step;
        const Eigen::VectorXd step_turned = equilibrium(with_law(turned, law), load_turned).step;
        for (int i = 0; i < 2 * static_cast<int>(model.spheres.size()); ++i)
            EXPECT_LT((step_turned.segment<3>(3 * i) - R * step.segment<3>(3 * i)).norm(), 1e-7);
    }
}

TEST(Equilibrium, FindsLongChainsFarFromRest) {
    const Model model = make_chain(40);
    for (const double F : {0.01, 0.1, 1.0, 10.0}) {
        const Load load = force_at(model, 40, {0, 0, F});
        const Equilibrium found = equilibrium(model, load);
        // The held end bears F at the arm of the tip: what flexion and the tip's place say is one and the same.
        const Eigen::VectorXd r = residual(model, found.state, load);
        EXPECT_NEAR(r[2], F, 1e-7 * F);
        EXPECT_NEAR(r[4], -found.state.x(40, 0) * F, 1e-6 * F * 400);
    }
}

TEST(Equilibrium, AStraightColumnBucklesBeyondItsCriticalLoadOnly) {
    // Turned by psi and pressed to the length l the link stands where kF psi = F l sin psi: the way to the side opens
    // where F l = kF with l = L - F / kE.
    const double L = 10, kE = 100, kF = 300;
    const Model column = make_chain(1, Vec3::UnitX(), {kE, kF, 200});
    const double critical = 0.5 * kE * (L - std::sqrt(L * L - 4 * kF / kE));
    const Equilibrium straight = equilibrium(column, force_at(column, 1, {-0.98 * critical, 0, 0}));
    EXPECT_LT(straight.step.segment<2>(7).norm(), 1e-9);
    const Equilibrium bent = equilibrium(column, force_at(column, 1, {-1.02 * critical, 0, 0}));
    EXPECT_GT(bent.step.segment<2>(7).norm(), 1);
}

// --- Messages -----------------------------------------------------------------------------------------------------

TEST(EquilibriumMessages, NothingHeld) {
    Model model = make_chain(2);
    model.spheres[0].held = false;
    EXPECT_EQ(message_of<InvalidInput>([&] { equilibrium(model, {}); }),
              "none of the model's 3 spheres is held, so nothing stops it from moving away: let a support hold one, or "
              "set its 'held' to true");
}

TEST(EquilibriumMessages, LooseSpheres) {
    Model model = make_chain(2);
    model.spheres.push_back(sphere_at({50, 1, 2}));
    model.spheres.push_back(sphere_at({60, 1, 2}));
    EXPECT_EQ(message_of<InvalidInput>([&] { equilibrium(model, {}); }),
              "sphere 3 at (50, 1, 2) hangs on no held sphere, and 2 of 5 do not: link it to the others or hold it");
}

TEST(EquilibriumMessages, AFreedomThatNoStiffnessKeeps) {
    Model model = make_chain(2);
    model.links[1].stiffness[2] = 0;
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        model.law = law;
        EXPECT_EQ(message_of<SolverFailure>([&] {
                      equilibrium(model, force_at(model, 2, {1, 0, 0}));
                  }),
                  "sphere 2 is free to turn about x: zero are torsion of links[1] "
                  "(spheres 1 and 2); raise one of them");
    }
}

TEST(EquilibriumMessages, PressedTooHardAtRest) {
    Model model = with_law(make_chain(1), EquilibriumLaw::linear);
    model.links[0].length = 100;
    EXPECT_EQ(message_of<SolverFailure>([&] { equilibrium(model, {}); }),
              "the model is not stable: sphere 1 would move along y by itself. Links that rest at another length than "
              "their spheres' distance, or loads beyond buckling, do that");
}

TEST(EquilibriumMessages, ALinkPressedToNothing) {
    // Too stiff against turning to give way to the side, and pressed beyond kE L = 20 N.
    const Model model = make_chain(1, Vec3::UnitX(), {2, 1e5, 1e5});
    EXPECT_EQ(
        message_of<SolverFailure>([&] {
            equilibrium(model, force_at(model, 1, {-30, 0, 0}));
        }),
        "the ends of a link of rest length 10 mm came to lie on one another; a smaller load or a stiffer link would "
        "keep them apart");
}

TEST(EquilibriumMessages, NotFound) {
    const Model model = make_chain(20);
    const std::string message = message_of<SolverFailure>([&] {
        equilibrium(model, force_at(model, 20, {0, 0, 1000}), {1e-9, 1});
    });
    EXPECT_NE(message.find("no equilibrium found in "), std::string::npos) << message;
    EXPECT_NE(message.find("0 % of it were reached by load stepping; lower the forces or raise the stiffness"),
              std::string::npos)
        << message;
}

TEST(EquilibriumMessages, OptionsOutOfRange) {
    const Model model = make_chain(1);
    EXPECT_EQ(message_of<InvalidInput>([&] { equilibrium(model, {}, {0}); }), "tolerance is 0; it must be above 0");
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  equilibrium(model, {}, {1e-9, 0});
              }),
              "iterations is 0; it must be at least 1");
}

}  // namespace
}  // namespace palpate::skeleton
