#include "identify/inference/particles/tempered_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "identify/inference/particles/resampling.h"
#include "identify/numerics/random.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

std::vector<GaussianProposal> round(const Eigen::VectorXd& mean, double sd) {
    return {{mean, {mean, Eigen::VectorXd::Constant(mean.size(), sd), nullptr}, {}, 1}};
}

double log_normal_density(double x, double mean, double sd) {
    return -0.5 * (x - mean) * (x - mean) / (sd * sd) - std::log(sd * std::sqrt(2 * std::numbers::pi));
}

/// y = A theta + noise with a standard normal prior: the posterior and the evidence are known.
struct LinearGaussian {
    Eigen::MatrixXd A;
    Eigen::VectorXd y;
    double sigma = 0.5;

    explicit LinearGaussian(int P, int n) : A(n, P) {
        for (int p = 0; p < P; ++p) A.col(p) = RandomStream(9, 0, p).normals(n);
        y = A * RandomStream(9, 1, 0).normals(P) + sigma * RandomStream(9, 2, 0).normals(n);
    }
    Eigen::MatrixXd precision() const {
        return A.transpose() * A / (sigma * sigma) + Eigen::MatrixXd::Identity(A.cols(), A.cols());
    }
    Eigen::VectorXd mean() const { return precision().ldlt().solve(A.transpose() * y / (sigma * sigma)); }
    double log_density(const Eigen::VectorXd& theta) const {
        double sum = 0;
        const Eigen::VectorXd modelled = A * theta;
        for (Eigen::Index i = 0; i < y.size(); ++i) sum += log_normal_density(y[i], modelled[i], sigma);
        for (const double t : theta) sum += log_normal_density(t, 0, 1);
        return sum;
    }
    double log_evidence() const {  // y ~ N(0, A A^T + sigma^2)
        const Eigen::MatrixXd V = A * A.transpose() + sigma * sigma * Eigen::MatrixXd::Identity(y.size(), y.size());
        const Eigen::LLT<Eigen::MatrixXd> llt(V);
        return -0.5 * y.dot(llt.solve(y)) - llt.matrixLLT().diagonal().array().log().sum() -
               0.5 * static_cast<double>(y.size()) * std::log(2 * std::numbers::pi);
    }
};

TEST(TemperedFilter, PosteriorOfALinearGaussianProblemIsExact) {
    const LinearGaussian problem(3, 8);
    TemperedOptions options{.particles = 4000, .seed = 3};
    const TemperedResult result = tempered_filter([&](const auto& theta) { return problem.log_density(theta); },
                                                  round(Eigen::VectorXd::Zero(3), 1.2), options);

    const Eigen::MatrixXd covariance = problem.precision().ldlt().solve(Eigen::MatrixXd::Identity(3, 3));
    const Eigen::VectorXd weights = result.log_weights.array().exp();
    const Eigen::VectorXd mean = result.particles.transpose() * weights;
    const Eigen::MatrixXd centered = result.particles.rowwise() - mean.transpose();
    const Eigen::MatrixXd spread = centered.transpose() * weights.asDiagonal() * centered;
    // five sigma of so many independent draws, twice that for resampled ones
    for (int p = 0; p < 3; ++p) {
        const double sd = std::sqrt(covariance(p, p));
        EXPECT_NEAR(mean[p], problem.mean()[p], 10 * sd / std::sqrt(options.particles));
        for (int q = 0; q <= p; ++q) {
            const double scale = sd * std::sqrt(covariance(q, q));
            EXPECT_NEAR(spread(p, q), covariance(p, q), 10 * std::sqrt(2.0 / options.particles) * scale);
        }
    }
    // its error goes as 1 / sqrt(N) a temperature: some 0.02 each, less than ten of them
    EXPECT_NEAR(result.log_evidence, problem.log_evidence(), 0.2);
    EXPECT_GT(result.acceptance, 0.05);
    EXPECT_EQ(result.history.front().temperature, 0);
    EXPECT_EQ(result.history.back().temperature, 1);
}

/// A standard normal prior in 1000 dimensions, and readings of 1 of the first `count`.
LogDensity readings_of_one(int count) {
    return [count](const Eigen::VectorXd& theta) {
        double sum = 0;
        for (int i = 0; i < count; ++i) sum += log_normal_density(1, theta[i], 0.5);
        for (const double t : theta) sum += log_normal_density(t, 0, 1);
        return sum;
    };
}

TEST(TemperedFilter, MovesDoNotDieWithTheDimension) {
    // proposal = prior, of whose draws 0.42^3 count
    const TemperedResult result =
        tempered_filter(readings_of_one(3), round(Eigen::VectorXd::Zero(1000), 1), {.particles = 400, .moves = 40});
    EXPECT_TRUE(result.weighed);
    EXPECT_GT(result.acceptance, 0.2);
    const Eigen::VectorXd weights = result.log_weights.array().exp();
    // posterior N(0.8, 0.2); five sigma of 400 draws of which a fifth counts
    EXPECT_NEAR(result.particles.col(0).dot(weights), 0.8, 5 * std::sqrt(0.2 / 80));
    EXPECT_NEAR(result.log_evidence, 3 * log_normal_density(1, 0, std::sqrt(1.25)), 0.5);
}

TEST(TemperedFilter, DrawsThatAreNearEnoughAreWeighedAtOnce) {
    // of the prior's draws one in three counts
    const TemperedResult result =
        tempered_filter(readings_of_one(1), round(Eigen::VectorXd::Zero(1000), 1), {.particles = 400});
    EXPECT_EQ(result.acceptance, 0);  // nothing was moved
    EXPECT_GT(result.particles.rows(), 400);
    EXPECT_EQ(result.evaluations, result.particles.rows());
    EXPECT_GE(result.history.back().effective_samples, 200);
    const Eigen::VectorXd weights = result.log_weights.array().exp();
    // posterior N(0.8, 0.2); five sigma of 200
    EXPECT_NEAR(result.particles.col(0).dot(weights), 0.8, 5 * std::sqrt(0.2 / 200));
    EXPECT_NEAR(result.log_evidence, log_normal_density(1, 0, std::sqrt(1.25)), 5 * std::sqrt(1.0 / 200));
}

TEST(TemperedFilter, EqualModesKeepEqualWeights) {
    // theta^2 is measured: +1 and -1 explain it alike
    const LogDensity density = [](const Eigen::VectorXd& theta) {
        return log_normal_density(theta[0] * theta[0], 1, 0.1) + log_normal_density(theta[0], 0, 2);
    };
    const TemperedResult result =
        tempered_filter(density, round(Eigen::VectorXd::Zero(1), 2), {.particles = 2000, .seed = 5});
    double right = 0;
    for (int i = 0; i < 2000; ++i) {
        EXPECT_NEAR(std::abs(result.particles(i, 0)), 1, 0.4);  // eight sigma of 0.05
        if (result.particles(i, 0) > 0) right += std::exp(result.log_weights[i]);
    }
    EXPECT_NEAR(right, 0.5, 5 * 0.5 / std::sqrt(500));  // five sigma, a quarter of the particles being independent
}

TEST(TemperedFilter, ModesOfDifferentWeightAndWidthAreWeighedFromAMixture) {
    // 30 % in a narrow mode, 70 % in a wide one, forty sd apart; and two Gaussians that overlap count once
    constexpr int P = 5;
    const auto normal = [](const Eigen::VectorXd& theta, double mean, double sd) {
        double sum = 0;
        for (const double t : theta) sum += log_normal_density(t, mean, sd);
        return sum;
    };
    const LogDensity density = [&](const Eigen::VectorXd& theta) {
        const double a = std::log(0.3) + normal(theta, -2, 0.1), b = std::log(0.7) + normal(theta, 2, 0.4);
        return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b)));
    };
    const auto at = [](double mean, double sd) { return round(Eigen::VectorXd::Constant(P, mean), sd).front(); };
    const std::vector<GaussianProposal> modes{at(-2.05, 0.12), at(2.1, 0.5), at(1.9, 0.4)};
    const TemperedResult result = tempered_filter(density, modes, {.particles = 3000, .seed = 2});
    double narrow = 0;
    for (int i = 0; i < 3000; ++i) {
        const double weight = std::exp(result.log_weights[i]);
        if (result.particles(i, 0) < 0) narrow += weight;
        EXPECT_TRUE(weight == 0 || (result.mode[i] == 0) == (result.particles(i, 0) < 0));
    }
    EXPECT_NEAR(narrow, 0.3, 0.05);            // five sigma of 3000 draws of which two thirds count
    EXPECT_NEAR(result.log_evidence, 0, 0.1);  // the density's integral is 1
}

TEST(TemperedFilter, ThreadsDoNotChangeANumber) {
    const LinearGaussian problem(4, 6);
    const auto run = [&](int threads) {
        return tempered_filter([&](const auto& theta) { return problem.log_density(theta); },
                               round(Eigen::VectorXd::Zero(4), 1), {.particles = 100, .threads = threads});
    };
    const TemperedResult one = run(1), four = run(4);
    EXPECT_EQ(one.particles, four.particles);
    EXPECT_EQ(one.log_evidence, four.log_evidence);
}

TEST(TemperedFilter, ParticlesWithoutDensityAreLeftBehind) {
    const LogDensity half_line = [](const Eigen::VectorXd& theta) {
        return theta[0] > 0 ? log_normal_density(theta[0], 0, 1) : -std::numeric_limits<double>::infinity();
    };
    const TemperedResult result = tempered_filter(half_line, round(Eigen::VectorXd::Zero(1), 1), {.particles = 1000});
    for (int i = 0; i < 1000; ++i) {
        EXPECT_TRUE(result.particles(i, 0) > 0 || std::exp(result.log_weights[i]) == 0);
    }
    EXPECT_NEAR(result.log_evidence, std::log(0.5), 5 / std::sqrt(1000));  // five sigma: half the draws count
}

TEST(TemperedFilter, WhatCannotBeWeighedKeepsItsSpread) {
    // 400 coordinates, each a posterior half as wide as the proposal: resampled particles would be copies
    constexpr int P = 400;
    const LogDensity density = [](const Eigen::VectorXd& theta) {
        return -0.5 * theta.squaredNorm() / 0.25 - P * std::log(0.5 * std::sqrt(2 * std::numbers::pi));
    };
    const TemperedResult result = tempered_filter(density, round(Eigen::VectorXd::Zero(P), 1), {.particles = 50});
    EXPECT_FALSE(result.weighed);
    const double spread = result.particles.squaredNorm() / static_cast<double>(result.particles.size());
    EXPECT_GT(spread, 0.25);                                  // not narrower than the posterior
    EXPECT_LT(spread, 0.95);                                  // on its way from the proposal
    EXPECT_NEAR(result.log_evidence, P * std::log(2), 1e-9);  // Laplace's at the mean: 1 / 0.5 each
    EXPECT_NEAR(effective_samples(result.log_weights), 50, 1e-9);
}

TEST(TemperedFilter, NoDensityAnywhereIsAFailure) {
    const LogDensity nowhere = [](const Eigen::VectorXd&) { return -std::numeric_limits<double>::infinity(); };
    EXPECT_THROW(tempered_filter(nowhere, round(Eigen::VectorXd::Zero(1), 1), {}), SolverFailure);
}

}  // namespace
}  // namespace palpate::identify
