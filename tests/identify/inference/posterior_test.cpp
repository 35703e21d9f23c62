#include "identify/inference/posterior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

/// Logarithms of stiffness, independent of each other but for numbers 3 and 8, which nearly add up to a constant.
Eigen::MatrixXd particles(int N, int P) {
    Eigen::MatrixXd logs(N, P);
    for (int p = 0; p < P; ++p) logs.col(p) = 0.3 * RandomStream(1, 0, p).normals(N);
    logs.col(8) = -logs.col(3) + 0.03 * RandomStream(2, 0, 0).normals(N);
    return logs.array().exp();
}

Eigen::VectorXd equal(int N) { return Eigen::VectorXd::Constant(N, -std::log(N)); }

TEST(StrongCorrelations, AreFound) {
    const std::vector<Correlation> found =
        strong_correlations(particles(200, 300), equal(200), Eigen::VectorXd::Constant(300, 0.7), 200);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].a, 3);
    EXPECT_EQ(found[0].b, 8);
    EXPECT_NEAR(found[0].value, -0.995, 0.003);  // 0.3 / sqrt(0.3^2 + 0.03^2), 200 draws
}

TEST(StrongCorrelations, ChanceIsNotOne) {
    // of a dozen draws, some of 45,000 pairs correlate by 0.7 and far more
    constexpr int N = 12, P = 300;
    const Eigen::VectorXd prior = Eigen::VectorXd::Constant(P, 0.7);
    EXPECT_GT(strong_correlations(particles(N, P), equal(N), prior, 1e9).size(), 90u);
    const std::vector<Correlation> estimate = strong_correlations(particles(N, P), equal(N), prior, N);
    ASSERT_LE(estimate.size(), 2u);
    ASSERT_GE(estimate.size(), 1u);
    EXPECT_EQ(estimate[0].a, 3);
}

TEST(StrongCorrelations, AreOfNumbersOfWhichSomethingIsKnown) {
    Eigen::VectorXd prior = Eigen::VectorXd::Constant(20, 0.7);
    prior[3] = 0.3;  // as wide as before the measurements
    EXPECT_TRUE(strong_correlations(particles(200, 20), equal(200), prior, 200).empty());
    prior.setConstant(std::numeric_limits<double>::infinity());
    EXPECT_EQ(strong_correlations(particles(200, 20), equal(200), prior, 200).size(), 1u);
}

}  // namespace
}  // namespace palpate::identify
