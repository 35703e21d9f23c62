#include "pipeline/synthesis/effects/strength.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::pipeline {
namespace {

/// Forces of one tool, a row each.
std::vector<Points> forces(double factor) {
    return {factor * Points{{0, 0, -0.4}}, factor * Points{{0.1, 0, -0.6}}, Points::Constant(1, 3, NAN)};
}

TEST(StrengthInForces, ACommonScalingLeavesNothingBeyond) {
    const Strength strength = strength_in_forces(forces(1), forces(1.2));
    const double rms = std::sqrt((0.4 * 0.4 + 0.1 * 0.1 + 0.6 * 0.6) / 6);  // of two rows: NaN does not count
    EXPECT_NEAR(strength.displacement, rms, 1e-15);                         // rounding
    EXPECT_NEAR(strength.change, 0.2 * rms, 1e-15);
    EXPECT_NEAR(strength.beyond, 0, 1e-15);
}

TEST(StrengthInForces, AChangeSquareToTheForcesIsAllBeyond) {
    std::vector<Points> hidden = forces(1);
    hidden[0](0, 1) += 0.3;  // along y, where nothing was felt
    const Strength strength = strength_in_forces(forces(1), hidden);
    EXPECT_NEAR(strength.change, 0.3 / std::sqrt(6.0), 1e-15);
    EXPECT_DOUBLE_EQ(strength.beyond, strength.change);
}

}  // namespace
}  // namespace palpate::pipeline
