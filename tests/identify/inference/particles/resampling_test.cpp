#include "identify/inference/particles/resampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "identify/numerics/random.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

Eigen::VectorXd some_log_weights(int n) {
    Eigen::VectorXd log_weights = 2 * RandomStream(1, 0, 0).normals(n);
    normalise(log_weights);
    return log_weights;
}

TEST(Resampling, LowVarianceKeepsProportionsWithinOneParticle) {
    constexpr int n = 50, count = 200;
    const Eigen::VectorXd log_weights = some_log_weights(n);
    for (const double u : {0.0, 0.37, 0.999}) {
        const std::vector<int> chosen = low_variance_resample(log_weights, count, u);
        ASSERT_EQ(chosen.size(), count);
        for (int i = 0; i < n; ++i) {
            const double expected = count * std::exp(log_weights[i]);
            const auto taken = static_cast<double>(std::ranges::count(chosen, i));
            EXPECT_LT(std::abs(taken - expected), 1 + 1e-9);  // rounding of the cumulated weights
        }
    }
}

TEST(Resampling, EqualWeightsTakeEachParticleOnce) {
    const Eigen::VectorXd log_weights = Eigen::VectorXd::Constant(10, -std::log(10));
    const std::vector<int> chosen = low_variance_resample(log_weights, 10, 0.5);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(chosen[i], i);
}

TEST(Resampling, NormalisedWeightsAddUpToOneHoweverSmall) {
    Eigen::VectorXd log_weights(3);
    log_weights << -1e5, -1e5 + std::log(2), -std::numeric_limits<double>::infinity();
    EXPECT_NEAR(normalise(log_weights), -1e5 + std::log(3), 1e-9);  // 1e5 carries 16 digits
    EXPECT_NEAR(log_weights.array().exp().sum(), 1, 1e-12);
    EXPECT_NEAR(std::exp(log_weights[1]), 2.0 / 3, 1e-9);
}

TEST(Resampling, NoWeightAtAllIsAFailure) {
    Eigen::VectorXd log_weights = Eigen::VectorXd::Constant(4, -std::numeric_limits<double>::infinity());
    try {
        normalise(log_weights);
        FAIL() << "no exception";
    } catch (const SolverFailure& failure) {
        EXPECT_NE(std::string(failure.what()).find("no particle has a weight"), std::string::npos);
    }
}

TEST(Resampling, EffectiveSamplesCountEqualParticles) {
    Eigen::VectorXd log_weights = Eigen::VectorXd::Constant(8, -std::numeric_limits<double>::infinity());
    log_weights.head(4).setConstant(-std::log(4));
    EXPECT_NEAR(effective_samples(log_weights), 4, 1e-12);
}

TEST(Resampling, QuantilesOfWeightsFollowTheirMass) {
    const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(1001, 0, 1);
    const Eigen::VectorXd even = Eigen::VectorXd::Constant(1001, 1.0 / 1001);
    EXPECT_NEAR(weighted_quantile(values, even, 0.25), 0.25, 1e-3);  // one value's weight
    const Eigen::VectorXd rising = 2 * values / 1001;                // density 2 x: quantile sqrt(q)
    EXPECT_NEAR(weighted_quantile(values, rising / rising.sum(), 0.25), 0.5, 1e-3);
}

TEST(RandomStream, IsDecidedByItsKeyAndStandardNormal) {
    EXPECT_EQ(RandomStream(1, 2, 3).normals(5), RandomStream(1, 2, 3).normals(5));
    EXPECT_NE(RandomStream(1, 2, 3).normals(5), RandomStream(1, 3, 2).normals(5));
    constexpr int n = 100000;
    const Eigen::VectorXd z = RandomStream(4, 5, 6).normals(n);
    EXPECT_NEAR(z.mean(), 0, 4 / std::sqrt(n));                        // four sigma
    EXPECT_NEAR(z.squaredNorm() / n, 1, 4 * std::sqrt(2.0 / n));       // four sigma
    EXPECT_NEAR(z.array().pow(4).mean(), 3, 4 * std::sqrt(96.0 / n));  // four sigma
}

}  // namespace
}  // namespace palpate::identify
