#include "skeleton/links/fibres/history_law.h"

#include <gtest/gtest.h>

#include <array>

#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/links/fibres/history_sensitivity.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using testing::force_at;
using testing::make_chain;
using testing::make_lattice;

constexpr fem::Damage soft{0.6, 0.05};
constexpr fem::Plasticity yielding{0.05, 0.25};

std::array<HistoryLaw, 3> laws() {
    return {HistoryLaw(fem::Effects{.plasticity = yielding}), HistoryLaw(fem::Effects{.damage = soft}),
            HistoryLaw(fem::Effects{.plasticity = yielding, .damage = soft})};
}

TEST(HistoryLaw, StressIsTheEnergysDerivative) {
    constexpr double h = 1e-6;
    for (const HistoryLaw& law : laws()) {
        const FibreState had = after_stretch(law, {}, 1.09);
        for (double lambda = 0.87; lambda < 1.2; lambda += 0.0127) {  // clear of where it yields, at 0.974 and 1.09
            const StretchTerms at = history_terms(law, had, lambda), up = history_terms(law, had, lambda + h),
                               down = history_terms(law, had, lambda - h);
            EXPECT_NEAR((up.energy - down.energy) / (2 * h), at.first, 1e-9);  // rounding over h
            EXPECT_NEAR((up.first - down.first) / (2 * h), at.second, 1e-7);
        }
    }
}

TEST(HistoryLaw, SlopesAreDerivatives) {
    constexpr double h = 1e-7;
    for (const HistoryLaw& law : laws()) {
        const FibreState had = after_stretch(law, {}, 1.09);
        const auto shifted = [&](int which, double by) {
            FibreState moved = had;
            (which == 0 ? moved.strain : which == 1 ? moved.accumulated : moved.most) += by;
            return moved;
        };
        const auto numbers = [&](const FibreState& before, double lambda) {
            const FibreState now = after_stretch(law, before, lambda);
            return Vec3(now.strain, now.accumulated, now.most);
        };
        for (const double lambda : {0.87, 0.99, 1.06, 1.16}) {
            const HistorySlopes slopes = history_slopes(law, had, lambda);
            // Rounding over h.
            EXPECT_LT(((numbers(had, lambda + h) - numbers(had, lambda - h)) / (2 * h) - slopes.state.col(0)).norm(),
                      1e-7);
            for (int c = 0; c < 3; ++c) {
                const FibreState up = shifted(c, h), down = shifted(c, -h);
                EXPECT_LT(((numbers(up, lambda) - numbers(down, lambda)) / (2 * h) - slopes.state.col(1 + c)).norm(),
                          1e-7);
                const double stress =
                    (history_terms(law, up, lambda).first - history_terms(law, down, lambda).first) / (2 * h);
                EXPECT_NEAR(stress, slopes.stress[c], 1e-5 * (1 + std::abs(stress))) << lambda << " " << c;
            }
        }
    }
}

TEST(HistoryLaw, ABarIsSofterUntilItIsPulledAsFarAgain) {
    constexpr double kE = 2, L = 10;
    const Model bar = make_chain(3, Vec3::UnitX(), {kE, 6000, 6000});
    const fem::Effects effects{.damage = soft};
    StaticsSolver solver(bar, effects);
    FibreStates before;
    // Strain under a pull; `stress` is a share of Young's modulus.
    const auto pull = [&](double stress) {
        const Equilibrium found =
            solver.solve(stiffness_vector(bar), force_at(bar, 3, {kE * L * stress, 0, 0}), {1e-12}, nullptr, before);
        before = flowed(bar, found, effects);
        return found.step[18] / (3 * L);
    };
    EXPECT_NEAR(pull(0.03), 0.03, 1e-10);  // as ever
    EXPECT_NEAR(pull(0.05), 0.05, 1e-10);
    const double first = pull(0.02);
    EXPECT_GT(first, 0.025);
    EXPECT_NEAR(pull(0), 0, 1e-10);  // and nothing stays
    EXPECT_NEAR(pull(0.02), first, 1e-10);
    EXPECT_NEAR(pull(0.05), 0.05, 1e-9);
    EXPECT_NEAR(pull(0.06), 0.06, 1e-10);
    for (const FibreState& fibre : before) EXPECT_NEAR(fibre.most, 1.5 * 0.06 * 0.06, 1e-9);
}

TEST(HistoryLaw, SensitivityIsThatOfEquilibriaAfterTheSameHistory) {
    testing::expect_sensitivity_after_history({.damage = fem::Damage{0.6, 0.02}});
}

}  // namespace
}  // namespace palpate::skeleton
