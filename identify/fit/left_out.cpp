#include "identify/fit/left_out.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "identify/parallel.h"

namespace palpate::identify {
namespace {

constexpr std::size_t least_probes = 3;  // of fewer, none can be forecast from the others

/// Rows of a group's states, one below the other.
struct Rows {
    Eigen::MatrixXd J;             // d errors / dv over sigma (N x r)
    Eigen::VectorXd sigma, error;  // [mm] (N); a missing coordinate has none
};

/// Of the coordinates that were measured in these states.
Rows rows_of(const std::vector<int>& states, const Slopes& slopes, const Eigen::MatrixXd& directions) {
    Rows rows;
    for (const int s : states) {
        const Eigen::VectorXd &weights = slopes.weights(s), &errors = slopes.errors(s);
        const Eigen::MatrixXd moved = slopes.moved_markers(s, directions);
        const Eigen::Index before = rows.error.size(), count = (weights.array() > 0).count();
        rows.J.conservativeResize(before + count, directions.cols());
        rows.sigma.conservativeResize(before + count);
        rows.error.conservativeResize(before + count);
        for (Eigen::Index i = 0, row = before; i < weights.size(); ++i) {
            if (weights[i] <= 0) continue;
            rows.sigma[row] = 1 / std::sqrt(weights[i]);
            rows.J.row(row) = -moved.row(i) / rows.sigma[row];
            rows.error[row++] = errors[i];
        }
    }
    return rows;
}

/// Errors under a fit to all states but these [mm]. `curvature`: of half of chi^2 and prior by the directions, of all.
Eigen::VectorXd unseen_errors(const Rows& rows, const Eigen::MatrixXd& curvature) {
    const Eigen::VectorXd d = rows.error.cwiseQuotient(rows.sigma);
    const Eigen::MatrixXd H = curvature - rows.J.transpose() * rows.J;
    const Eigen::VectorXd step = H.ldlt().solve(rows.J.transpose() * d);
    return rows.error + rows.sigma.cwiseProduct(rows.J * step);
}

}  // namespace

ForecastError left_out_error(const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
                             const std::vector<int>& probes, int threads) {
    std::map<int, std::vector<int>> by_probe;
    for (int s = 0; s < static_cast<int>(probes.size()); ++s) by_probe[probes[s]].push_back(s);
    if (by_probe.size() < least_probes) return {};
    std::vector<std::vector<int>> groups;
    groups.reserve(by_probe.size());
    for (const auto& [probe, states] : by_probe) groups.push_back(states);

    const Slopes slopes = domain.slopes(fit.theta, fit.prediction);
    const Eigen::MatrixXd& vectors = fit.spectrum.vectors;
    const Eigen::MatrixXd directions = prior.coloured(vectors);
    // a spectrum without room for all is one of the way there
    Eigen::MatrixXd curvature = fit.spectrum.is_whole
                                    ? Eigen::MatrixXd(fit.spectrum.values.asDiagonal())
                                    : Eigen::MatrixXd(vectors.transpose() * whitened_curvature(slopes, prior)(vectors));
    curvature.diagonal().array() += 1;
    Eigen::VectorXd relative(std::ssize(groups));  // squared
    for_each_in_parallel(static_cast<int>(groups.size()), threads, [&](int g) {
        const Rows rows = rows_of(groups[g], slopes, directions);
        double noise = 0, scale = 0;  // squares, over the coordinates [mm^2]
        for (const int s : groups[g]) {
            noise += domain.states()[s].coordinates * domain.squared_noise(s);
            scale += domain.states()[s].coordinates * domain.squared_scale(s);
        }
        relative[g] = std::max(0.0, unseen_errors(rows, curvature).squaredNorm() - noise) / scale;
    });
    return {std::sqrt(relative.mean()), domain.least_displacement(), static_cast<int>(groups.size())};
}

}  // namespace palpate::identify
