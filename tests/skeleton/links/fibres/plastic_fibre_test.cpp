#include <gtest/gtest.h>

#include "skeleton/links/fibres/plastic_fibre.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/links/fibres/history_sensitivity.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using testing::force_at;
using testing::make_chain;
using testing::make_lattice;
using testing::with_law;

constexpr double kE = 2, L = 10;
constexpr fem::Plasticity material{0.05, 0.25};

// A bar of three links that goes through loads one after another, so wide that it neither buckles nor twists.
class PlasticBar : public ::testing::Test {
protected:
    Equilibrium play(const Load& load) {
        StaticsSolver solver(bar, {.plasticity = material});
        const Equilibrium found = solver.solve(stiffness_vector(bar), load, {1e-12}, nullptr, before);
        before = flowed(bar, found, {.plasticity = material});
        return found;
    }
    // Strain under a pull; `stress` is a share of Young's modulus.
    double pull(double stress) { return play(force_at(bar, 3, {kE * L * stress, 0, 0})).step[18] / (3 * L); }

    Model bar = make_chain(3, Vec3::UnitX(), {kE, 6000, 6000});
    FibreStates before;
};

TEST_F(PlasticBar, IsThePlainOneBelowYield) {
    for (const Vec3& F : {Vec3(kE * L * 0.049, 0, 0), Vec3(-0.3, 0.02, 0)}) {
        const Load load = force_at(bar, 3, F);
        EXPECT_EQ(play(load).step, equilibrium(bar, load, {1e-12}).step);
    }
}

TEST_F(PlasticBar, YieldsHardensAndKeepsASet) {
    const auto [y, h] = material;
    // Beyond yield the slope is E h / (1 + h).
    EXPECT_NEAR(pull(0.06), y + (0.06 - y) * (1 + h) / h, 1e-10);
    EXPECT_NEAR(pull(0.08), y + (0.08 - y) * (1 + h) / h, 1e-10);
    const double set = (0.08 - y) / h;
    for (const FibreState& fibre : before) {
        EXPECT_NEAR(fibre.strain, set, 1e-10);
        EXPECT_NEAR(fibre.accumulated, set, 1e-10);
    }
    // Unloaded it keeps the plastic strain, loaded again it is elastic as far as it had been.
    EXPECT_NEAR(pull(0), set, 1e-10);
    EXPECT_NEAR(pull(0.08), set + 0.08, 1e-10);
    EXPECT_NEAR(pull(0.09), y + (0.09 - y) * (1 + h) / h, 1e-10);
}

TEST_F(PlasticBar, HardensAlikeBothWays) {
    pull(0.07);  // flows by 0.08: the yield stress is 0.07 now
    EXPECT_NEAR(pull(-0.07), 0.08 - 0.07, 1e-10);
    EXPECT_NEAR(before[0].accumulated, 0.08, 1e-10);
    pull(-0.08);
    EXPECT_NEAR(before[0].accumulated, 0.12, 1e-10);
    EXPECT_NEAR(before[0].strain, 0.04, 1e-10);
}

TEST_F(PlasticBar, StaysBentAsItWasBent) {
    for (Link& link : bar.links) link.stiffness[1] = 16;  // of a rod of 4 mm radius
    const Load load = force_at(bar, 3, {0, 0.12, 0});
    const double tip = play(load).step[19];
    EXPECT_GT(tip, equilibrium(bar, load).step[19] + 0.5);
    const double left = play({}).step[19];
    EXPECT_GT(left, 0.5);
    EXPECT_LT(left, tip);
    EXPECT_NEAR(play({}).step[19], left, 1e-9);  // and nothing more flows
}

TEST_F(PlasticBar, BendsOnHoweverMuchOfItFlows) {
    // Softer in bending than its section has it: without fibres of its own softness it would give way.
    constexpr double rod = 2;
    for (Link& link : bar.links) {
        link.gyration = rod;
        link.stiffness[1] = 0.4 * 2 * kE * rod * rod;
    }
    double last = 0;
    for (int i = 1; i <= 6; ++i) {
        const double tip = play(force_at(bar, 3, {0, 0.02 * i, 0})).step[19];
        EXPECT_GT(tip, last);
        last = tip;
    }
    for (const FibreState& fibre : before) EXPECT_LT(fibre.accumulated, 1);
    EXPECT_GT(before[1].accumulated + before[2].accumulated + before[3].accumulated, 0);
}

TEST_F(PlasticBar, NeverFlowsByTheLinearLaw) {
    bar.law = EquilibriumLaw::linear;
    EXPECT_NEAR(pull(0.5), 0.5, 1e-12);
    EXPECT_TRUE(before.empty());
    // What had flowed before counts.
    before.assign(fibres_per_link * bar.links.size(), {0.04, 0.04});
    EXPECT_NEAR(pull(0.02), 0.06, 1e-12);
    EXPECT_EQ(before.size(), 36u);
}

TEST(PlasticFibre, StressIsTheEnergysDerivative) {
    const FibreState had{0.03, 0.05};
    const double h = 1e-6;
    for (double lambda = 0.8; lambda < 1.3; lambda += 0.013) {
        const StretchTerms at = plastic_terms(material, had, lambda);
        const StretchTerms up = plastic_terms(material, had, lambda + h),
                           down = plastic_terms(material, had, lambda - h);
        EXPECT_NEAR((up.energy - down.energy) / (2 * h), at.first, 1e-9);  // rounding over h
        EXPECT_NEAR((up.first - down.first) / (2 * h), at.second, 1e-8);
        // The stress lies on or in the yield surface.
        const FibreState now = flow(material, had, lambda);
        EXPECT_LE(std::abs(lambda - 1 - now.strain), material.yield + material.hardening * now.accumulated + 1e-15);
    }
}

TEST(PlasticSensitivity, IsThatOfEquilibriaAfterTheSameHistory) {
    const FibreStates before = testing::expect_sensitivity_after_history({.plasticity = fem::Plasticity{0.01, 0.3}});
    EXPECT_GT(std::ranges::count_if(before, [](const FibreState& f) { return f.accumulated > 0; }), 20);
}

}  // namespace
}  // namespace palpate::skeleton
