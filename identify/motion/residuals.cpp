#include "identify/motion/residuals.h"

#include <algorithm>

namespace palpate::identify {
namespace {

/// How long a row of errors is like itself, in instants: 1 + 2 sum of its correlations, until they are lost; of all
/// rows together.
double correlation_time(const Eigen::MatrixXd& errors) {
    constexpr double lost = 0.05;  // smaller ones are hardly told from chance: 2 / sqrt(n) of 1600 instants
    const double square = errors.squaredNorm();
    double time = 1;
    for (Eigen::Index lag = 1; lag < errors.cols() / 2 && square > 0; ++lag) {
        const double alike =
            errors.leftCols(errors.cols() - lag).cwiseProduct(errors.rightCols(errors.cols() - lag)).sum() / square;
        if (alike < lost) break;
        time += 2 * alike;
    }
    return time;
}

/// How many rows of errors there are as far as they differ: tr(S)^2 / tr(S^2) of their covariance S, what as many
/// independent rows of so few instants would show beside that taken off.
double independent_rows(const Eigen::MatrixXd& errors, double instants) {
    const Eigen::MatrixXd S = errors * errors.transpose();
    const double square = S.trace() * S.trace();
    if (square == 0) return static_cast<double>(errors.rows());
    const double alike = S.squaredNorm() / square, by_chance = 1 / std::max(1.0, instants);
    return 1 / std::max(alike - by_chance, 1 / static_cast<double>(errors.rows()));
}

}  // namespace

ResidualStatistics residuals(const RingdownFit& fit, const Ringdowns& ringdowns, const Eigen::VectorXd& theta) {
    ResidualStatistics all;
    for (int r = 0; r < static_cast<int>(ringdowns.recordings.size()); ++r) {
        const Eigen::MatrixXd errors = fit.errors(theta, r);
        const auto read = (ringdowns.recordings[r].weights.array() > 0).count();
        const double time = correlation_time(errors), instants = static_cast<double>(errors.cols()) / time;
        all.square += errors.squaredNorm();
        all.readings += static_cast<int>(read);
        all.independent += std::min(static_cast<double>(read), instants * independent_rows(errors, instants));
    }
    return all;
}

double variance_of(const ResidualStatistics& left, bool noise_is_known) {
    const double variance = left.square / std::max(1, left.readings);
    return std::max(variance, noise_is_known ? 1.0 : 1e-18) * left.readings / std::max(1.0, left.independent);
}

}  // namespace palpate::identify
