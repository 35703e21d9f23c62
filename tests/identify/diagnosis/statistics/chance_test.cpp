#include "identify/diagnosis/statistics/chance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "identify/diagnosis/statistics/held_out.h"
#include "identify/diagnosis/statistics/largest_noise.h"
#include "identify/numerics/random.h"

// How far right explanations err by chance.

namespace palpate::identify {
namespace {

TEST(LargestNoise, IsAQuantileOfChiSquare) {
    // chi^2 tables: 99.61 is exceeded with a probability of 0.001 for 60 degrees of freedom, 124.34 with 0.05 for 100.
    EXPECT_NEAR(largest_noise(60, 1e-3), std::sqrt(99.607 / 60), 1e-4);
    EXPECT_NEAR(largest_noise(100, 0.05), std::sqrt(124.342 / 100), 1e-4);
}

/// A linear model of 5 numbers for 72 readings under 6 probes, each probe with a contact of its own that shifts.
class LinearFit : public testing::Test {
protected:
    static constexpr int probes = 6, rows = 72, numbers = 5;

    LinearFit() {
        problem_.measured.setZero(rows);
        problem_.sigma.setOnes(rows);
        problem_.markers = 1;
        problem_.coordinate.assign(rows, 0);
        for (int p = 0; p < probes; ++p) problem_.probe.push_back(p);
        for (int n = 0; n < rows; ++n) problem_.action.push_back(n / (rows / probes));
        RandomStream random(5, 0, 0);
        fit_.columns.resize(rows, numbers);
        for (int c = 0; c < numbers; ++c) fit_.columns.col(c) = random.normals(rows);
        fit_.prior_mean.setZero(numbers);
        fit_.prior_sd.setConstant(numbers, 100);
        fit_.nuisances.columns.setZero(rows, probes);
        for (int n = 0; n < rows; ++n) fit_.nuisances.columns(n, problem_.action[n]) = 2 * random.normal();
        fit_.nuisances.precisions.setConstant(probes, 4);
        fit_.error.setZero(rows);
        weights_ = Eigen::VectorXd::Constant(rows, 0.8);
        fit_.V.emplace(weights_, fit_.nuisances.columns, fit_.nuisances.precisions);
        fit_.explanation.theta.setZero(numbers);
    }

    /// Readings of the model, fitted: in a fit's place, as leave_probes_out sees it.
    Refit fitted(int draw) const {
        RandomStream random(6, 1, static_cast<std::uint64_t>(draw));
        const Eigen::VectorXd d = fit_.columns * (3 * random.normals(numbers)) +
                                  fit_.nuisances.columns * (0.5 * random.normals(probes)) +
                                  weights_.cwiseInverse().cwiseProduct(random.normals(rows));
        Eigen::MatrixXd H = fit_.columns.transpose() * fit_.V->apply(fit_.columns);
        H.diagonal().array() += 1e-4;
        Refit result = fit_;
        result.explanation.theta = H.llt().solve(fit_.columns.transpose() * fit_.V->apply(d));
        result.error = d - fit_.columns * result.explanation.theta;
        result.whitened_rms = std::sqrt(result.error.dot(fit_.V->apply(result.error).col(0)) / rows);
        return result;
    }

    /// Of a whitened rms of all rows.
    static double sd() { return 1 / std::sqrt(2.0 * rows); }

    Problem problem_;
    Refit fit_;
    Eigen::VectorXd weights_;
};

TEST_F(LinearFit, ExceedsTheBoundAsOftenAsIsStated) {
    constexpr int draws = 4000;
    constexpr double probability = 0.05;
    const double bound = largest_held_out(problem_, fit_, probability);
    int above = 0;
    for (int i = 0; i < draws; ++i) above += leave_probes_out(problem_, fitted(i)).whitened_rms > bound ? 1 : 0;
    // The bound comes from 400 draws: mean and sd to 0.05 and 0.035 sd, the tail of 5 % to +-0.7 %; 4 of that and of
    // the draws' own 0.34 %.
    EXPECT_NEAR(above / double{draws}, probability, 4 * std::hypot(0.007, 0.0034));
}

TEST_F(LinearFit, ErrorsOfFewProbesHangTogether) {
    // Each probe's errors are chi^2 of its readings; were they independent, so would be the sum.
    EXPECT_GT(largest_held_out(problem_, fit_, 1e-3), largest_noise(rows, 1e-3));
    fit_.columns *= 1e-9;  // nothing that probes share
    // Mean and sd of 400 draws, to 0.05 and 0.035 sd, are off by 0.12 sd at 3.09 sd; a normal tail in chi^2's place by
    // as much.
    EXPECT_NEAR(largest_held_out(problem_, fit_, 1e-3), largest_noise(rows, 1e-3), 4 * 0.17 * sd());
}

}  // namespace
}  // namespace palpate::identify
