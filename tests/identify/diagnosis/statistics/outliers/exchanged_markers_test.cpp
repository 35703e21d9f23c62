#include "identify/diagnosis/statistics/outliers/exchanged_markers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "identify/diagnosis/statistics/outliers/outliers.h"
#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr int markers = 3, states = 6;
constexpr double reading_sigma = 0.1;

/// Three markers 20 mm apart in six states, as a small rig reads them: 18 readings.
class SmallRig : public testing::Test {
protected:
    SmallRig() {
        MeasurementSet set;
        for (int m = 0; m < markers; ++m) set.markers.push_back({m, Vec3(20 * m, 5 * m * m, 0), {}});
        for (int s = 0; s < states; ++s) {
            LoadState state{.probe = s, .contacts = {{Vec3::Zero(), Vec3(0, 0, 1 + s), 1}}};
            for (int m = 0; m < markers; ++m) state.readings.push_back({m, set.markers[m].rest});
            set.states.push_back(state);
        }
        problem_ = make_problem(set, reading_sigma);
        errors_ = RandomStream(3, 0, 0).normals(static_cast<int>(problem_.rows()));
    }

    /// Exchanges the labels of two readings.
    void exchange(int one, int other) {
        const Vec3 apart = problem_.measured.segment<3>(3 * other) - problem_.measured.segment<3>(3 * one);
        problem_.measured.segment<3>(3 * one) += apart;
        problem_.measured.segment<3>(3 * other) -= apart;
        errors_.segment<3>(3 * one) += apart / reading_sigma;
        errors_.segment<3>(3 * other) -= apart / reading_sigma;
    }

    std::vector<ExchangedMarkers> found() const {
        return find_exchanged_markers(problem_, noise_alone(problem_.rows()), errors_);
    }

    Problem problem_;
    Eigen::VectorXd errors_;
};

TEST_F(SmallRig, NothingIsExchangedInPureNoise) { EXPECT_THAT(found(), IsEmpty()); }

TEST_F(SmallRig, ExchangedLabelsAreFoundAndTheirReadingsSetAside) {
    exchange(12, 14);  // of state 4
    const auto pairs = found();
    ASSERT_EQ(pairs.size(), 1u);
    EXPECT_EQ(pairs[0].state, 4);
    EXPECT_EQ(pairs[0].markers, std::pair(0, 2));
    EXPECT_EQ(pairs[0].readings, std::pair(12, 14));
    // Both are off by the distance of the markers, sqrt(40^2 + 20^2) mm or 447 sigmas: half the sum of the squares.
    EXPECT_NEAR(pairs[0].log_likelihood_ratio, 447.2 * 447.2, 0.02 * 447.2 * 447.2);

    // Two of 18 readings are more than a tenth, but not as an exchange.
    const Outliers outliers = find_outliers(problem_, errors_, pairs);
    EXPECT_THAT(outliers.readings, UnorderedElementsAre(12, 14));
    EXPECT_EQ(outliers.exchanged.size(), 1u);
    EXPECT_GT(outliers.log_bayes_factor, 1e5);
}

TEST_F(SmallRig, TwoStatesMayEachHaveAnExchange) {
    exchange(0, 1);
    exchange(16, 17);
    EXPECT_EQ(found().size(), 2u);
}

/// A fit of a few numbers to few readings bends to the wrong labels: judged by what it leaves, others look exchanged.
TEST_F(SmallRig, AFitThatWasBentByThemHidesNoExchange) {
    constexpr int numbers = 6;
    exchange(12, 14);
    Eigen::MatrixXd C(problem_.rows(), numbers);
    for (int c = 0; c < numbers; ++c) C.col(c) = RandomStream(4, 0, c).normals(static_cast<int>(problem_.rows()));
    C.middleRows<9>(36) *= 10;  // state 4 tells most of them
    const Eigen::VectorXd precisions = Eigen::VectorXd::Constant(numbers, 1e-6);
    const Whitening V(Eigen::VectorXd::Ones(problem_.rows()), C, precisions);
    errors_ = V.residual(errors_);  // less what the fit explains
    for (const ExchangedMarkers& pair : found()) EXPECT_NE(pair.readings, std::pair(12, 14));
    const auto pairs = find_exchanged_markers(problem_, V, errors_);
    ASSERT_EQ(pairs.size(), 1u);
    EXPECT_EQ(pairs[0].readings, std::pair(12, 14));
}

TEST_F(SmallRig, WhatMovesBothMarkersIsNoExchange) {
    for (const int reading : {12, 14}) errors_.segment<3>(3 * reading) += Vec3(200, 0, 50);
    EXPECT_THAT(found(), IsEmpty());
}

TEST_F(SmallRig, AReadingWithoutACoordinateIsNotExchanged) {
    exchange(12, 14);
    std::vector<char> keep(problem_.rows(), 1);
    keep[3 * 14 + 1] = 0;
    Eigen::VectorXd errors(problem_.rows() - 1);
    for (Eigen::Index n = 0, at = 0; n < problem_.rows(); ++n) {
        if (keep[n]) errors[at++] = errors_[n];
    }
    EXPECT_THAT(find_exchanged_markers(problem_.with_rows(keep), noise_alone(errors.size()), errors), IsEmpty());
}

}  // namespace
}  // namespace palpate::identify
