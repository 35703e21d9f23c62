#include "identify/measurements/labels/coherent_drift.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpate::identify {
namespace {

constexpr int most_carriers = 100;
constexpr int most_iterations = 200;
constexpr double settled = 1e-4;   // of sigma^2
constexpr double rounding = 1e-9;  // of tau^2, on the covariance's diagonal: nearby carriers are all but the same

Eigen::MatrixXd squared_distances(const Points& a, const Points& b) {
    Eigen::MatrixXd D = -2 * a * b.transpose();
    D.colwise() += a.rowwise().squaredNorm();
    D.rowwise() += b.rowwise().squaredNorm().transpose();
    return D.cwiseMax(0);
}

/// Some of the points, each the farthest from those before.
Points spread_out(const Points& points, int count) {
    if (points.rows() <= count) return points;
    Points chosen(count, 3);
    Eigen::VectorXd nearest = Eigen::VectorXd::Constant(points.rows(), std::numeric_limits<double>::infinity());
    Eigen::Index next = 0;
    for (int c = 0; c < count; ++c) {
        chosen.row(c) = points.row(next);
        nearest = nearest.cwiseMin(squared_distances(points, points.row(next)).col(0));
        nearest.maxCoeff(&next);
    }
    return chosen;
}

/// The prior of the field v: v(points) = B a, a ~ N(0, S^-1) of each component.
struct SmoothField {
    Eigen::MatrixXd B, S;  // (m x c), (c x c)

    SmoothField(const Points& points, const DriftOptions& options) {
        const Points carriers = spread_out(points, most_carriers);
        const auto covariance = [&](const Points& a, const Points& b) -> Eigen::MatrixXd {
            const double width = 2 * options.smoothness * options.smoothness;
            return options.reach * options.reach * (-squared_distances(a, b).array() / width).exp();
        };
        B = covariance(points, carriers);
        S = covariance(carriers, carriers);
        S.diagonal().array() += rounding * options.reach * options.reach;
    }
};

/// P at the moved points.
Eigen::MatrixXd memberships(const Points& moved, const Points& readings, const std::vector<int>& known, double variance,
                            double outliers) {
    const auto m = moved.rows(), n = readings.rows();
    Eigen::MatrixXd P = (squared_distances(moved, readings).array() / (-2 * variance)).exp();
    for (const int point : known) {
        if (point >= 0) P.row(point).setZero();
    }
    const double gaussian =
        std::pow(2 * std::numbers::pi * variance, 1.5) * static_cast<double>(m) / static_cast<double>(n);
    const Eigen::RowVectorXd sums = P.colwise().sum().array() + outliers * gaussian;
    P.array().rowwise() /= sums.array().max(std::numeric_limits<double>::min());
    for (Eigen::Index r = 0; r < n; ++r) {
        if (known[r] < 0) continue;
        P.col(r).setZero();
        P(known[r], r) = 1;
    }
    return P;
}

}  // namespace

Drift coherent_drift(const Points& points, const Points& readings, const std::vector<int>& known,
                     const DriftOptions& options) {
    const SmoothField field(points, options);
    const Eigen::Array3d box = (points.colwise().maxCoeff() - points.colwise().minCoeff()).transpose();
    const double volume = box.max(options.first_sigma).prod();
    const double outliers = options.outlier_share / (1 - options.outlier_share) / volume;

    Drift drift{points, {}, options.first_sigma, 0};
    while (drift.iterations++ < most_iterations) {
        const double variance = drift.sigma * drift.sigma;
        drift.P = memberships(drift.moved, readings, known, variance, outliers);
        const Eigen::VectorXd share = drift.P.rowwise().sum();
        const double all = share.sum();
        if (all == 0) break;

        // the most probable field: (B^T diag(share) B + sigma^2 S) a = B^T (P readings - diag(share) points)
        const Eigen::MatrixXd H = field.B.transpose() * share.asDiagonal() * field.B + variance * field.S;
        const Points pull = drift.P * readings - share.asDiagonal() * points;
        drift.moved = points + field.B * H.ldlt().solve(field.B.transpose() * pull);

        const double left = drift.P.cwiseProduct(squared_distances(drift.moved, readings)).sum() / (3 * all);
        drift.sigma = std::max(options.least_sigma, std::sqrt(left));
        if (std::abs(drift.sigma * drift.sigma / variance - 1) < settled) break;
    }
    return drift;
}

}  // namespace palpate::identify
