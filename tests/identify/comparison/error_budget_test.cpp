// The error budget: shares that add up, whatever the numbers.

#include "identify/comparison/error_budget.h"

#include <gtest/gtest.h>

namespace palpate::identify {
namespace {

constexpr double share_rounding = 1e-15;  // of sums of three shares

TEST(ErrorBudget, SharesAddUp) {
    for (const double error : {0.1, 1.0, 7.0}) {
        for (const double noise : {0.0, 0.5, 3.0}) {
            for (const double left : {0.0, 0.6, 20.0}) {
                const ErrorBudget b = split_error_budget(error, noise, left);
                EXPECT_NEAR(b.noise + b.reduction + b.missing_physics, 1, share_rounding);
                for (const double share : {b.noise, b.reduction, b.missing_physics}) {
                    EXPECT_GE(share, -share_rounding);
                    EXPECT_LE(share, 1 + share_rounding);
                }
            }
        }
    }
}

/// Noise 1, coarseness 3 and physics 6 of a mean square error of 10: variances of independent errors add.
TEST(ErrorBudget, RecoversIndependentParts) {
    const ErrorBudget b = split_error_budget(10, 1, 1 + 6);
    EXPECT_NEAR(b.noise, 0.1, share_rounding);
    EXPECT_NEAR(b.missing_physics, 0.6, share_rounding);
    EXPECT_NEAR(b.reduction, 0.3, share_rounding);
}

TEST(ErrorBudget, AnErrorBelowTheNoiseIsNoise) { EXPECT_EQ(split_error_budget(0.9, 1, 5).noise, 1); }

TEST(ErrorBudget, AReferenceAsGoodAsItsNoiseLacksNoPhysics) {
    EXPECT_EQ(split_error_budget(4, 1, 0.9).missing_physics, 0);
}

}  // namespace
}  // namespace palpate::identify
