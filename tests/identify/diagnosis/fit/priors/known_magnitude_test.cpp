#include "identify/diagnosis/fit/priors/known_magnitude.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace palpate::identify {
namespace {

constexpr MagnitudePrior unit{1, 0.002};
const Vec3 prior_sd = Vec3::Constant(1 / std::sqrt(3.0));

double normal(const Vec3& x, const Vec3& mean, const Mat3& C) {
    const Vec3 off = x - mean;
    return std::exp(-0.5 * off.dot(C.inverse() * off)) / std::sqrt(std::pow(2 * M_PI, 3) * C.determinant());
}

TEST(KnownMagnitude, OfAVectorThatIsKnownWellIsTheRatioOfDensities) {
    // Within 1 % all about the sphere is flat: its posterior is the free one's cut by it.
    const Vec3 g(0.36, -0.48, -0.8);
    const Mat3 C = Vec3(1e-4, 2e-4, 1.5e-4).asDiagonal();
    const KnownMagnitude found = with_known_magnitude(g, C, prior_sd, unit);
    EXPECT_LT((found.value - g).norm(), 1e-3);
    // ln of integral N(g; free, C) p(g) dg / N(g; 0, prior): across the sphere N(0; 0, g.C g + sd^2) / 4 pi
    const double across = g.dot(C * g) + unit.sd * unit.sd;
    const Mat3 prior = prior_sd.cwiseAbs2().asDiagonal();
    EXPECT_NEAR(found.log_bayes_factor,
                std::log(1 / std::sqrt(2 * M_PI * across) / (4 * M_PI) / normal(g, Vec3::Zero(), prior)), 0.02);
    // Conditioned on a plane: C - C g g' C / (g' C g + sd^2)
    const Mat3 cut = C - (C * g) * (C * g).transpose() / across;
    EXPECT_LT((found.covariance - cut).norm(), 0.03 * cut.norm());
}

TEST(KnownMagnitude, OfAnotherSizeIsRefuted) {
    const Mat3 C = Mat3::Identity() * 1e-4;
    EXPECT_LT(with_known_magnitude(Vec3(0, 0, -0.5), C, prior_sd, unit).log_bayes_factor, -1000);
    EXPECT_LT(with_known_magnitude(Vec3(0, 0, -1.06), C, prior_sd, unit).log_bayes_factor, -10);
}

TEST(KnownMagnitude, LeavesOpenWhatTheMeasurementsDo) {
    // Along x nothing is known, and across it nine tenths: x may be +-0.44.
    const Mat3 C = Vec3(0.3, 1e-4, 1e-4).asDiagonal();
    const KnownMagnitude found = with_known_magnitude(Vec3(0.05, 0, -0.9), C, prior_sd, unit);
    EXPECT_NEAR(found.value.norm(), 1, 1e-12);
    EXPECT_NEAR(found.value.x(), std::sqrt(1 - 0.81), 0.03);
    EXPECT_NEAR(found.value.z(), -0.9, 0.015);
    EXPECT_GT(std::sqrt(found.covariance(0, 0)), 0.5 * 0.87);  // as far as the other
    EXPECT_LT(std::sqrt(found.covariance(2, 2)), 0.02);
}

TEST(KnownMagnitude, IsTheSameInAnyFrame) {
    const Mat3 R = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    const Mat3 C = Vec3(0.1, 1e-3, 4e-4).asDiagonal();
    const Vec3 g(0.3, 0.1, -0.96);
    const KnownMagnitude one = with_known_magnitude(g, C, prior_sd, unit),
                         other = with_known_magnitude(R * g, R * C * R.transpose(), prior_sd, unit);
    EXPECT_NEAR(one.log_bayes_factor, other.log_bayes_factor, 0.01);
    EXPECT_LT((R * one.value - other.value).norm(), 1e-3);
}

}  // namespace
}  // namespace palpate::identify
