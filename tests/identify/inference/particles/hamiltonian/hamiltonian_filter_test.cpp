// Hamiltonian Monte Carlo against posteriors that are known.

#include "identify/inference/particles/hamiltonian/hamiltonian_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>

#include "identify/inference/particles/hamiltonian/chains.h"
#include "identify/inference/particles/hamiltonian/convergence.h"
#include "identify/inference/particles/hamiltonian/evidence.h"
#include "identify/inference/particles/resampling.h"
#include "identify/numerics/random.h"
#include "mesh/errors.h"
#include "tests/identify/inference/particles/hamiltonian/nonlinear_readings.h"

namespace palpate::identify {
namespace {

NonlinearReadings readings_of(int P, double sigma, int key) {
    NonlinearReadings readings{Eigen::VectorXd(P), Eigen::VectorXd::Constant(P, sigma)};
    for (int i = 0; i < P; ++i) {
        RandomStream random(key, 0, i);
        const double truth = NonlinearReadings::prior_sd * random.normal();
        readings.y[i] = std::exp(-truth) + sigma * random.normal();
    }
    return readings;
}

struct Off {
    double mean = 0;      // rms over the numbers, in sd
    double sd_ratio = 0;  // mean of the sd's ratio to the exact one
    double log_evidence = 0;
};

Off compared(const TemperedResult& result, const NonlinearReadings& readings) {
    const Eigen::VectorXd weights = result.log_weights.array().exp();
    const auto P = static_cast<double>(readings.y.size());
    Off off;
    for (Eigen::Index i = 0; i < readings.y.size(); ++i) {
        const NonlinearReadings::Exact exact = readings.exact(i);
        const double mean = result.particles.col(i).dot(weights);
        const double sd = std::sqrt((result.particles.col(i).array() - mean).square().matrix().dot(weights));
        off.mean += std::pow((mean - exact.mean) / exact.sd, 2) / P;
        off.sd_ratio += sd / exact.sd / P;
        off.log_evidence += exact.log_evidence;
    }
    off.mean = std::sqrt(off.mean);
    return off;
}

TEST(HamiltonianFilter, SkewedPosteriorOf288NumbersIsThatOfExactIntegrals) {
    const NonlinearReadings readings = readings_of(288, 0.3, 3);
    const TemperedResult result =
        hamiltonian_filter(readings.density(), readings.proposal(), {.particles = 600, .chains = 10, .seed = 2});
    const Off off = compared(result, readings);
    EXPECT_GE(result.particles.rows(), 600);
    EXPECT_LT(off.mean, 0.1);  // 1 / sqrt(600) of independent draws is 0.04
    EXPECT_NEAR(off.sd_ratio, 1, 0.05);
    EXPECT_NEAR(result.log_evidence, off.log_evidence, 4 * result.log_evidence_sd + 0.5);
    EXPECT_LT(result.log_evidence_sd, 4);
    EXPECT_LT(result.r_hat, 1.1);
    EXPECT_GT(result.independent, 200);
    EXPECT_GT(result.acceptance, 0.5);
    EXPECT_TRUE(result.weighed);
    EXPECT_EQ(result.history.front().temperature, 0);
    EXPECT_EQ(result.history.back().temperature, 1);
}

TEST(HamiltonianFilter, LaplaceAloneIsOffThere) {
    // what sampling corrects: the mode of a skewed density is not its mean
    const NonlinearReadings readings = readings_of(288, 0.3, 3);
    double off = 0;
    for (Eigen::Index i = 0; i < 288; ++i) {
        const NonlinearReadings::Exact exact = readings.exact(i);
        off += std::pow((exact.mode - exact.mean) / exact.sd, 2) / 288;
    }
    EXPECT_GT(std::sqrt(off), 0.2);
}

TEST(HamiltonianFilter, RidgeIsSampledAlong) {
    // only the sum of two numbers is read, a hundred times as well as the prior knows each
    constexpr double sigma = 0.01;
    const DensityWithGradient ridge = [](const Eigen::VectorXd& theta, Eigen::VectorXd& gradient) {
        const double error = (theta[0] + theta[1] - 1) / sigma;
        gradient = -theta;
        gradient.array() -= error / sigma;
        return -(error * error + theta.squaredNorm()) / 2;
    };
    GaussianProposal q{Eigen::VectorXd::Constant(2, 0.5), {}, {}, 1};
    q.prior = {Eigen::VectorXd::Zero(2), Eigen::VectorXd::Ones(2), nullptr};
    q.spectrum = {Eigen::VectorXd::Constant(1, 2 / (sigma * sigma)), Eigen::VectorXd::Constant(2, std::sqrt(0.5))};
    const TemperedResult result = hamiltonian_filter(ridge, q, {.particles = 1000, .chains = 10});
    const Eigen::VectorXd across = result.particles.rowwise().sum(),
                          along = result.particles.col(0) - result.particles.col(1);
    const auto sd = [](const Eigen::VectorXd& x) { return std::sqrt((x.array() - x.mean()).square().mean()); };
    // five sigma of an sd of 1000 draws
    EXPECT_NEAR(sd(across), sigma, 5 * sigma / std::sqrt(2000));
    EXPECT_NEAR(sd(along), std::sqrt(2.0), 5 * std::sqrt(2.0) / std::sqrt(2000));
    EXPECT_NEAR(along.mean(), 0, 5 * std::sqrt(2.0 / 1000));
}

TEST(HamiltonianFilter, ThreadsDoNotChangeANumber) {
    const NonlinearReadings readings = readings_of(20, 0.2, 1);
    const auto run = [&](int threads) {
        return hamiltonian_filter(readings.density(), readings.proposal(),
                                  {.particles = 24, .chains = 4, .threads = threads});
    };
    const TemperedResult one = run(1), four = run(4);
    EXPECT_EQ(one.particles, four.particles);
    EXPECT_EQ(one.log_evidence, four.log_evidence);
}

TEST(HamiltonianFilter, NoDensityAnywhereIsAFailure) {
    const DensityWithGradient nowhere = [](const Eigen::VectorXd&, Eigen::VectorXd&) {
        return -std::numeric_limits<double>::infinity();
    };
    EXPECT_THROW(hamiltonian_filter(nowhere, readings_of(3, 0.1, 1).proposal(), {}), SolverFailure);
}

TEST(HamiltonianFilter, DensityThatJumpsEverywhereIsAFailure) {
    // a comb: no step is short enough
    const DensityWithGradient comb = [](const Eigen::VectorXd& theta, Eigen::VectorXd& gradient) {
        gradient.setZero();
        return 1e4 * std::sin(1e9 * theta[0]);
    };
    EXPECT_THROW(hamiltonian_filter(comb, readings_of(1, 0.1, 1).proposal(), {.particles = 20}), SolverFailure);
}

TEST(HamiltonianMoves, LeaveADensityAsItIs) {
    // draws of the posterior itself, by inverting its integral, moved with steps so long that many are rejected
    NonlinearReadings readings = readings_of(1, 0.5, 7);
    const GaussianProposal q = readings.proposal();
    constexpr int N = 4000, bins = 20;
    std::vector<double> grid, cumulated;
    double sum = 0;
    for (double t = -4; t < 4; t += 1e-3) {
        sum += std::exp(-readings.half_square(t, 0));
        grid.push_back(t);
        cumulated.push_back(sum);
    }
    const auto place_of = [&](double u) {
        return static_cast<std::size_t>(std::ranges::lower_bound(cumulated, u * sum) - cumulated.begin());
    };
    const DensityWithGradient density = readings.density();
    HamiltonianMoves moves(density, q, 1, 1);
    Chains chains = moves.draw(N, 0);
    for (int i = 0; i < N; ++i) {
        const double theta = grid[place_of((i + 0.5) / N)];
        chains.z.col(i) = q.whitened(Eigen::VectorXd::Constant(1, theta));
        Eigen::VectorXd gradient(1);
        const double value = density(Eigen::VectorXd::Constant(1, theta), gradient);
        chains.log_ratio[i] = value - moves.log_proposal(chains.z.col(i));
        chains.gradient.col(i) = q.gradients_by_z(gradient) + chains.z.col(i);
    }
    double accepted = 0;
    for (int round = 1; round <= 5; ++round) accepted += moves.move(chains, 1, 1.5, round) / 5;
    EXPECT_LT(accepted, 0.95);
    EXPECT_GT(accepted, 0.2);
    const Eigen::MatrixXd theta = moves.parameters(chains.z);
    std::vector<int> counts(bins);
    for (const double t : theta.reshaped()) {
        const auto place = static_cast<std::size_t>(std::ranges::lower_bound(grid, t) - grid.begin());
        const double u = cumulated[std::min(place, grid.size() - 1)] / sum;
        ++counts[std::min(bins - 1, static_cast<int>(u * bins))];
    }
    double chi_squared = 0;
    for (const int count : counts) chi_squared += std::pow(count - N / bins, 2) / (N / bins);
    EXPECT_GT(boost::math::gamma_q((bins - 1) / 2.0, chi_squared / 2), 1e-3);
}

TEST(Convergence, TellsCloudsApartThatHaveSeenDifferentThings) {
    Eigen::MatrixXd a(3, 200), b(3, 200);
    for (int i = 0; i < 200; ++i) {
        a.col(i) = RandomStream(1, 0, i).normals(3);
        b.col(i) = RandomStream(1, 1, i).normals(3);
    }
    const Convergence alike = convergence({a, b}, 10);
    EXPECT_LT(alike.r_hat, 1.03);
    EXPECT_NEAR(alike.effective, 400, 160);  // chains' means of ten tell a correlation to a third
    b.row(2).array() += 2;
    EXPECT_GT(convergence({a, b}, 10).r_hat, 1.5);
    // chains that stay where they began are worth one draw each
    for (int i = 10; i < 200; ++i) a.col(i) = a.col(i % 10);
    EXPECT_LT(convergence({a, a}, 10).effective, 40);
}

TEST(Evidence, IntegratesAGaussianBetweenGaussians) {
    // pi = exp(-x^2 / 2 s^2) next to q = N(0, 1): along q^(1-b) pi^b the variance of x is 1 / (1 + c b)
    constexpr double s = 0.5, c = 1 / (s * s) - 1;
    std::vector<TemperatureNode> nodes;
    for (double b = 0; b <= 1.001; b += 0.1) {
        const double variance = 1 / (1 + c * b);
        nodes.push_back({b, -c * variance / 2, c * c * variance * variance / 2, 1e-4});
    }
    const Evidence evidence = integrated_evidence(nodes);
    EXPECT_NEAR(evidence.log_value, std::log(s), 2e-4);  // of the rule's next term
    EXPECT_GT(evidence.sd, 0.003);                       // eleven nodes of 0.01 each
    EXPECT_LT(evidence.sd, 0.02);
    EXPECT_NEAR(together({1, 0.1}, {3, 0.1}).sd, 1, 1e-12);  // two that differ are not known better than that
}

/// The rank of the truth among particles, over many sets drawn from the prior, is uniform. [Talts et al. 2018]
template <typename Sample>
double rank_uniformity(int sets, int P, const Sample& sample) {
    constexpr int bins = 10;
    std::vector<int> counts(bins);
    for (int set = 0; set < sets; ++set) {
        NonlinearReadings readings{Eigen::VectorXd(P), Eigen::VectorXd::Constant(P, 0.4)};
        Eigen::VectorXd truth(P);
        RandomStream random(11, 1, set);
        for (int i = 0; i < P; ++i) {
            truth[i] = NonlinearReadings::prior_sd * random.normal();
            readings.y[i] = std::exp(-truth[i]) + 0.4 * random.normal();
        }
        const TemperedResult result = sample(readings, set);
        const Eigen::VectorXd weights = result.log_weights.array().exp();
        // of one number a set, so that ranks are independent
        const int p = set % P;
        const double below = (result.particles.col(p).array() < truth[p]).select(weights.array(), 0).sum();
        ++counts[std::min(bins - 1, static_cast<int>(below * bins))];
    }
    double chi_squared = 0;
    const double each = static_cast<double>(sets) / bins;
    for (const int count : counts) chi_squared += std::pow(count - each, 2) / each;
    return boost::math::gamma_q((bins - 1) / 2.0, chi_squared / 2);
}

TEST(SimulationBasedCalibration, RanksOfWeighedParticlesAreUniform) {
    const double p = rank_uniformity(500, 2, [](const NonlinearReadings& readings, int set) {
        return tempered_filter(
            [&](const Eigen::VectorXd& theta) {
                Eigen::VectorXd gradient(theta.size());
                return readings.density()(theta, gradient);
            },
            {readings.proposal()}, {.particles = 100, .seed = static_cast<std::uint64_t>(set)});
    });
    EXPECT_GT(p, 1e-3);  // fails by chance once in a thousand seeds; this one is fixed
}

TEST(SimulationBasedCalibration, RanksOfHamiltonianParticlesAreUniform) {
    const double p = rank_uniformity(500, 6, [](const NonlinearReadings& readings, int set) {
        return hamiltonian_filter(readings.density(), readings.proposal(),
                                  {.particles = 100, .chains = 5, .seed = static_cast<std::uint64_t>(set)});
    });
    EXPECT_GT(p, 1e-3);
}

}  // namespace
}  // namespace palpate::identify
