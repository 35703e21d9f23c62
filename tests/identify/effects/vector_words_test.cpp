#include "identify/effects/vector_words.h"

#include <gtest/gtest.h>

#include "identify/effects/measurement/gains.h"

namespace palpate::identify {
namespace {

Mat3 variances(double x, double y, double z) { return Vec3(x * x, y * y, z * z).asDiagonal(); }

TEST(VectorInWords, TellsSizeAndDirection) {
    EXPECT_EQ(vector_in_words({20, -90, -9200}, variances(300, 320, 460), 1000, "m/s^2"), "9.2 ± 0.5 m/s^2 along -z");
    EXPECT_EQ(vector_in_words({0.06, 0.08, 0}, variances(0.001, 0.001, 0.001), 0.01, "percent", "about"),
              "10.00 ± 0.10 percent about (0.60, 0.80, 0.00)");
}

TEST(VectorInWords, WhatIsNotDeterminedStandsApart) {
    EXPECT_EQ(vector_in_words({4700, -90, -9200}, variances(4200, 320, 460), 1000, "m/s^2"),
              "9.2 ± 0.5 m/s^2 along -z; along x it is not determined (5 ± 4)");
    // An axis that is nearly x is called x, and what is told besides has nothing along x.
    const Vec3 tilted(0.99, 0, 0.14);
    EXPECT_EQ(
        vector_in_words({3550, -90, -9130}, variances(400, 320, 400) + 9e6 * tilted * tilted.transpose(), 1000, "m/s²"),
        "9.1 ± 0.6 m/s² along -z; along x it is not determined (4 ± 3)");
    const Vec3 open(1, 1, 0);
    const Mat3 covariance = variances(1, 1, 1) + 100 * open * open.transpose();
    EXPECT_EQ(vector_in_words({3, 4, -20}, covariance, 1, "mm"),
              "20.0 ± 1.0 mm along -z; along (0.71, 0.71, 0.00) it is not determined (5 ± 14)");
}

/// However much worse it is known than the other axes, a part that cannot be 0 is told.
TEST(VectorInWords, WhatIsFarFromZeroIsDetermined) {
    EXPECT_EQ(vector_in_words({16, 0, -12}, variances(5, 0.1, 0.1), 1, "mm"), "20 ± 4 mm along (0.80, 0.00, -0.60)");
    EXPECT_EQ(vector_in_words({9, 0, -12}, variances(5, 0.1, 0.1), 1, "mm"),
              "12.00 ± 0.10 mm along -z; along x it is not determined (9 ± 5)");
    EXPECT_TRUE(is_undetermined({.value = 9, .sd = 5, .rest = 12, .least_sd = 0.1}));
    EXPECT_FALSE(is_undetermined({.value = 11, .sd = 5, .rest = 12, .least_sd = 0.1}));
    EXPECT_FALSE(is_undetermined({.value = 9, .sd = 5, .rest = 21, .least_sd = 0.1}));
    EXPECT_FALSE(is_undetermined({.value = 9, .sd = 5, .rest = 12, .least_sd = 2}));
}

TEST(VectorInWords, PoorlyKnownAllRoundIsNotTakenApart) {
    EXPECT_EQ(vector_in_words({0, 0, 5}, variances(3, 3, 3), 1, "mm"), "5 ± 3 mm along +z");
    EXPECT_EQ(vector_in_words(Vec3::Zero(), Mat3::Zero(), 1, "mm"), "0 mm");
}

TEST(DirectionInWords, HasNoNegativeZero) {
    EXPECT_EQ(direction_in_words({-0.001, 3, -4}), "(0.00, 0.60, -0.80)");
    EXPECT_EQ(components_in_words({-0.0, -0.004, -1}), "(0.00, 0.00, -1.00)");
    EXPECT_EQ(components_in_words({-0.006, 0, 1}), "(-0.01, 0.00, 1.00)");
}

TEST(NumberInWords, HasItsStandardDeviationWhereItIsKnown) {
    const skeleton::EffectRecord record{"viscosity", {{"creep", 0.24, "1"}, {"tau", 3.1, "s"}}};
    EXPECT_EQ(number_in_words(record, 0, {}, 100), "24");
    const Eigen::MatrixXd covariance = Eigen::Vector2d(0.02 * 0.02, 0.5 * 0.5).asDiagonal();
    EXPECT_EQ(number_in_words(record, 0, covariance, 100), "24.0 ± 2.0");
    EXPECT_EQ(number_in_words(record, 0, covariance, -100), "-24.0 ± 2.0");
    EXPECT_EQ(number_in_words(record, 1, covariance), "3.1 ± 0.5");
}

TEST(GainRange, IsOfTheLeastAndTheMost) {
    const skeleton::EffectRecord record{"force-gain", {{"probe1", 1.2, "1"}, {"probe2", 0.8, "1"}, {"probe3", 1, "1"}}};
    const GainRange range = gain_range(record, {});
    EXPECT_EQ(range.least.name, "probe2");
    EXPECT_EQ(range.least.in_words, number_in_words(record, 1, {}));
    EXPECT_EQ(range.most.name, "probe1");
    EXPECT_EQ(range.most.in_words, number_in_words(record, 0, {}));
}

}  // namespace
}  // namespace palpate::identify
