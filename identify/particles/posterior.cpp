#include "identify/particles/posterior.h"

#include <cmath>
#include <limits>

#include "identify/particles/resampling.h"

namespace palpate::identify {
namespace {

constexpr double informed_share = 0.7;  // of the prior's sd

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

}  // namespace palpate::identify
