#include "identify/inference/maximum/force_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::identify {
namespace {

constexpr int most_iterations = 100;  // a bound: it ends before where a step promises nothing
constexpr double enough = 1e-10;      // of ln density, that a step promises
constexpr double least_share = 1e-8;  // of the loads and forces, that a net force is sure to: rounding of equilibria

double squared_error(const ForceStatistics& s, const Eigen::VectorXd& m) {
    return std::max(0.0, m.dot(s.H * m) + 2 * s.g.dot(m) + s.c);
}

}  // namespace

double ForcePosterior::log_density(const Eigen::VectorXd& theta) const {
    const double e = squared_error(statistics, theta.array().exp());
    return prior.log_density(theta) - e / (2 * sigma * sigma) -
           statistics.rows * std::log(sigma * std::sqrt(2 * std::numbers::pi));
}

double force_noise(const ForceStatistics& statistics, const Eigen::VectorXd& multipliers) {
    const auto fitted = std::min(static_cast<double>((multipliers.array() > 0).count()), 0.75 * statistics.rows);
    const double left = squared_error(statistics, multipliers) / (statistics.rows - fitted);
    const double forces = multipliers.dot(statistics.H * multipliers) + statistics.c;
    return std::sqrt(std::max(left, least_share * least_share * forces / statistics.rows));
}

ForceFit fit_forces(const ForcePosterior& posterior, const Eigen::VectorXd& start) {
    const ForceStatistics& s = posterior.statistics;
    const LogNormalPrior& prior = posterior.prior;
    const double variance = posterior.sigma * posterior.sigma;
    const Eigen::SparseMatrix<double> prior_precision = prior.precision();
    ForceFit fit{start, nullptr, {-posterior.log_density(start)}};

    for (int i = 0; i < most_iterations; ++i) {
        const Eigen::VectorXd m = fit.theta.array().exp();
        const Eigen::VectorXd g = m.cwiseProduct(s.H * m + s.g) / variance + prior_precision * (fit.theta - prior.mean);
        const Eigen::SparseMatrix<double> curvature = m.asDiagonal() * s.H * m.asDiagonal();
        fit.spread = std::make_shared<MarkovField>(curvature / variance + prior_precision);
        const Eigen::VectorXd step = -fit.spread->coloured(fit.spread->transposed(g));
        if (-g.dot(step) / 2 < enough) break;

        // as far as the density rises, no ratio larger than e
        double share = std::min(1.0, 1 / step.cwiseAbs().maxCoeff());
        while (share > 1e-6 && -posterior.log_density(fit.theta + share * step) >= fit.trace.back()) share /= 2;
        if (share <= 1e-6) break;
        fit.theta += share * step;
        fit.trace.push_back(-posterior.log_density(fit.theta));
    }
    return fit;
}

}  // namespace palpate::identify
