#include "identify/diagnosis/statistics/mesh_evidence.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>

namespace palpate::identify {
namespace {

/// How many of the fit's last numbers are of what the explanation adds: it follows what was there before.
Eigen::Index count_added(const FittedExplanation& explained) {
    const std::vector<Eigen::VectorXd>& values = explained.fit.explanation.values;
    Eigen::Index count = 0;
    for (auto own = values.end() - std::ssize(explained.effects); own != values.end(); ++own) count += own->size();
    return count;
}

/// What was taken off for the mesh, probe by probe, over sigma (N x probes).
Eigen::MatrixXd corrections_of_probes(const Problem& problem) {
    std::map<int, Eigen::Index> column_of;
    for (const int probe : problem.probe) column_of.try_emplace(probe, std::ssize(column_of));
    Eigen::MatrixXd corrections = Eigen::MatrixXd::Zero(problem.rows(), std::ssize(column_of));
    for (Eigen::Index n = 0; n < problem.rows(); ++n)
        corrections(n, column_of.at(problem.probe[problem.action[n]])) = problem.discretisation[n] / problem.sigma[n];
    return corrections;
}

}  // namespace

double evidence_of_mesh_error(const Problem& problem, const FittedExplanation& explained, double share, double rarity) {
    if (problem.discretisation.size() == 0) return 0;
    const Refit& fit = explained.fit;
    const Eigen::Index added = count_added(explained), others = fit.columns.cols() - added;
    Eigen::MatrixXd unknown(fit.columns.rows(), fit.nuisances.columns.cols() + others);
    unknown << fit.nuisances.columns, fit.columns.leftCols(others);
    Eigen::VectorXd precisions(unknown.cols());
    precisions << fit.nuisances.precisions, fit.prior_sd.head(others).cwiseAbs2().cwiseInverse();
    const Whitening V(fit.V->weights(), unknown, precisions);

    const Eigen::MatrixXd S = fit.columns.rightCols(added), VS = V.apply(S);
    Eigen::MatrixXd M = S.transpose() * VS;
    M.diagonal() += fit.prior_sd.tail(added).cwiseAbs2().cwiseInverse();
    const Eigen::MatrixXd G = VS.transpose() * corrections_of_probes(problem);
    const Eigen::MatrixXd Q = G.transpose() * M.ldlt().solve(G);
    const double largest =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Q, Eigen::EigenvaluesOnly).eigenvalues()[Q.rows() - 1];
    return 0.5 * share * share * (Q.trace() + 2 * Q.norm() * std::sqrt(rarity) + 2 * largest * rarity);
}

}  // namespace palpate::identify
