#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "identify/numerics/summaries.h"

// Numbers that stand for several others.

namespace palpate::identify {
namespace {

TEST(LogMeanExp, IsTheLogarithmOfTheMeanWithoutOverflow) {
    // ln((1 + 3) / 2); a common factor comes out, however large.
    EXPECT_DOUBLE_EQ(log_mean_exp(std::vector<double>{0, std::log(3.0)}), std::log(2.0));
    EXPECT_DOUBLE_EQ(log_mean_exp(std::vector<double>{1e4, 1e4 + std::log(3.0)}), 1e4 + std::log(2.0));
    EXPECT_DOUBLE_EQ(log_mean_exp(std::vector<double>{-INFINITY, 0}), -std::log(2.0));
}

TEST(KnownPart, IsZeroWhereNothingIsKnown) {
    EXPECT_EQ(known_part(NAN), 0);
    EXPECT_EQ(known_part(-2.5), -2.5);
    EXPECT_EQ(known_part(Eigen::Vector3d(1, NAN, -3)), Eigen::Vector3d(1, 0, -3));
}

TEST(NormalDistribution, HoldsThatShareWithinItsBounds) {
    // seven digits of the bound; the density there is 0.058 on either side
    EXPECT_NEAR(std::erf(sds_of_95_percent / std::sqrt(2.0)), 0.95, 1e-7);
}

}  // namespace
}  // namespace palpate::identify
