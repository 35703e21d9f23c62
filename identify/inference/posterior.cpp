#include "identify/inference/posterior.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "identify/inference/particles/resampling.h"

namespace palpate::identify {
namespace {

constexpr double informed_share = 0.7;          // of the prior's sd
constexpr double worth_knowing = 0.7;           // correlation
constexpr std::size_t most_correlations = 100;  // that are told: more are not read
constexpr double hardly_informed = 0.9;         // of the prior's sd: what hangs together is known in part

struct Moments {
    double mean, sd;
};

Moments moments(const Eigen::VectorXd& values, const Eigen::VectorXd& weights) {
    const double mean = weights.dot(values);
    return {mean, std::sqrt(weights.dot((values.array() - mean).square().matrix()))};
}

}  // namespace

StiffnessPrior stiffness_prior(const Parameters& parameters, const LogNormalPrior& prior) {
    const Eigen::ArrayXd variance = prior.sd.array().square();
    StiffnessPrior result;
    result.mean = parameters.units().array() * (prior.mean.array() + variance / 2).exp();
    result.sd = result.mean.array() * (variance.exp() - 1).sqrt();
    result.log_sd = prior.sd;
    return result;
}

StiffnessPrior stiffness_prior(const Parameters& parameters, double low, double high) {
    return {parameters.units() * (low + high) / 2, parameters.units() * (high - low) / std::sqrt(12.0),
            Eigen::VectorXd::Constant(parameters.size(), std::numeric_limits<double>::infinity())};
}

std::vector<Correlation> strong_correlations(const Eigen::MatrixXd& particles, const Eigen::VectorXd& log_weights,
                                             const Eigen::VectorXd& prior_log_sd, double independent) {
    // standardised logarithms, weights taken in: S^T S is the matrix of correlations, taken a strip at a time
    const Eigen::VectorXd weights = log_weights.array().exp();
    Eigen::MatrixXd S = particles.array().max(std::numeric_limits<double>::min()).log();
    S.rowwise() -= (weights.transpose() * S).eval();
    S = weights.cwiseSqrt().asDiagonal() * S;
    std::vector<int> known;
    for (int p = 0; p < static_cast<int>(S.cols()); ++p) {
        if (S.col(p).norm() <= hardly_informed * prior_log_sd[p]) known.push_back(p);
    }
    S = S(Eigen::all, known).eval();
    S.colwise().normalize();
    const double pairs = 0.5 * static_cast<double>(S.cols() * S.cols());
    const double by_chance = std::tanh(std::sqrt(2 * std::log(std::max(1.0, pairs)) / std::max(1.0, independent - 3)));
    const double least = std::max(worth_knowing, by_chance);

    std::vector<Correlation> result;
    constexpr Eigen::Index strip = 256;  // columns: wide enough for matrix products at full speed
    for (Eigen::Index first = 0; first < S.cols(); first += strip) {
        const Eigen::Index count = std::min(strip, S.cols() - first);
        const Eigen::MatrixXd R = S.middleCols(first, count).transpose() * S.rightCols(S.cols() - first);
        for (Eigen::Index a = 0; a < count; ++a) {
            for (Eigen::Index b = first + a + 1; b < S.cols(); ++b) {
                if (std::abs(R(a, b - first)) >= least) result.push_back({known[first + a], known[b], R(a, b - first)});
            }
        }
    }
    std::ranges::stable_sort(result, std::greater{}, [](const Correlation& c) { return std::abs(c.value); });
    if (result.size() > most_correlations) result.resize(most_correlations);
    return result;
}

Eigen::MatrixXd stiffness_of(const Parameters& parameters, const Eigen::MatrixXd& theta) {
    return theta.array().exp().matrix() * parameters.units().asDiagonal();
}

std::vector<PosteriorRow> posterior_rows(const Parameters& parameters, const Eigen::MatrixXd& particles,
                                         const Eigen::VectorXd& log_weights, const StiffnessPrior& prior) {
    const Eigen::VectorXd weights = log_weights.array().exp();
    std::vector<PosteriorRow> rows;
    for (int p = 0; p < parameters.size(); ++p) {
        const Parameter& parameter = parameters.list[p];
        const Eigen::VectorXd k = particles.col(p);
        PosteriorRow row;
        row.parameter = parameter.name;
        row.link = parameter.link;
        row.unit = skeleton::stiffness_units[static_cast<int>(parameter.kind)];
        row.mean = moments(k, weights).mean;
        row.sd = moments(k, weights).sd;
        row.q025 = weighted_quantile(k, weights, 0.025);
        row.q50 = weighted_quantile(k, weights, 0.5);
        row.q975 = weighted_quantile(k, weights, 0.975);
        row.prior_mean = prior.mean[p];
        row.prior_sd = prior.sd[p];
        row.informed = row.sd <= informed_share * prior.sd[p] &&
                       moments(k.array().log(), weights).sd <= informed_share * prior.log_sd[p];
        rows.push_back(std::move(row));
    }
    return rows;
}

void report_particles(const Parameters& parameters, const LogNormalPrior& prior,
                      const std::vector<Eigen::VectorXd>& mode_locations, TemperedResult& filter,
                      IdentifyResult& result) {
    const Eigen::MatrixXd stiffness = stiffness_of(parameters, filter.particles);
    const double independent = filter.independent > 0 ? filter.independent : effective_samples(filter.log_weights);
    result.posterior = posterior_rows(parameters, stiffness, filter.log_weights, stiffness_prior(parameters, prior));
    result.correlations = strong_correlations(stiffness, filter.log_weights, prior.sd, independent);
    Eigen::Index best = 0;
    filter.log_density.maxCoeff(&best);
    result.best = stiffness.row(best);

    for (const Eigen::VectorXd& top : mode_locations) {
        result.modes.push_back({0, parameters.units().array() * top.array().exp()});
    }
    for (std::size_t i = 0; i < filter.mode.size(); ++i) {
        result.modes[filter.mode[i]].probability += std::exp(filter.log_weights[static_cast<Eigen::Index>(i)]);
    }
    for (Mode& mode : result.modes) mode.probability = std::min(mode.probability, 1.0);  // sums round
    std::ranges::stable_sort(result.modes, std::greater{}, &Mode::probability);

    for (FilterStep& step : filter.history) {
        step.particles = stiffness_of(parameters, step.particles);
        result.history.push_back(std::move(step));
    }
    result.log_evidence = filter.log_evidence;
    result.log_evidence_sd = filter.log_evidence_sd;
    result.effective_samples = independent;
    result.r_hat = filter.r_hat;
    result.acceptance = filter.acceptance;
}

}  // namespace palpate::identify
