#include "identify/diagnosis/fit/scatter.h"

#include <algorithm>
#include <map>

namespace palpate::identify {
namespace {

/// Covariance of the numbers by how far each probe pulls at them: C (sum_p s_p s_p^T) C P/(P - 1), s_p what the errors
/// of probe p that the nuisances do not explain add to the slope of the objective. Errors that the readings of a probe
/// share, as those of a mesh, show there, and not in C. [Liang & Zeger 1986; the "sandwich"]
Eigen::MatrixXd scatter_of_probes(const Problem& problem, const Refit& at) {
    const Eigen::VectorXd unexplained = at.residual.cwiseQuotient(at.V->weights());  // d - A nuisances
    const Eigen::MatrixXd slopes = at.V->apply(at.columns);
    std::map<int, Eigen::VectorXd> pulls;
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const auto [pull, is_new] = pulls.try_emplace(problem.probe[problem.action[n]]);
        if (is_new) pull->second.setZero(at.columns.cols());
        pull->second += unexplained[n] * slopes.row(n).transpose();
    }
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(at.columns.cols(), at.columns.cols());
    for (const auto& [probe, pull] : pulls) sum += pull * pull.transpose();
    const auto probes = static_cast<double>(pulls.size());
    return at.covariance * sum * at.covariance * (probes / std::max(probes - 1, 1.0));
}

/// How far the numbers move by what may be left of each error of the mesh that was taken off the readings (p x errors).
Eigen::MatrixXd shifts_by_mesh(const FitPriors& priors, const Refit& at) {
    const Eigen::Index errors = at.nuisances.of_mesh, others = at.nuisances.columns.cols() - errors;
    const Whitening V(at.V->weights(), at.nuisances.columns.leftCols(others), at.nuisances.precisions.head(others));
    const Eigen::MatrixXd VA = V.apply(at.columns);
    Eigen::MatrixXd H = at.columns.transpose() * VA;
    H.diagonal() += priors.precisions();
    const Eigen::MatrixXd left = at.nuisances.columns.rightCols(errors) *
                                 at.nuisances.precisions.tail(errors).cwiseSqrt().cwiseInverse().asDiagonal();
    return H.llt().solve(VA.transpose() * left);
}

}  // namespace

Eigen::MatrixXd scatter_of(const Problem& problem, const FitPriors& priors, const Refit& at) {
    const Eigen::MatrixXd of_probes = scatter_of_probes(problem, at);
    if (at.nuisances.of_mesh == 0) return of_probes;
    const Eigen::MatrixXd shifts = shifts_by_mesh(priors, at);
    return of_probes + shifts * shifts.transpose();
}

}  // namespace palpate::identify
