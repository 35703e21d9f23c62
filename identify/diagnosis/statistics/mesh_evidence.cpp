#include "identify/diagnosis/statistics/mesh_evidence.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>

namespace palpate::identify {
namespace {

/// Which numbers of the fit the explanation adds (numbers).
std::vector<char> added_numbers(const FittedExplanation& explained) {
    const Explanation& all = explained.fit.explanation;
    std::vector<char> added(static_cast<std::size_t>(all.theta.size()), 0);
    for (std::size_t e = 0; e < all.effects.size(); ++e)
        added.insert(added.end(), static_cast<std::size_t>(all.values[e].size()),
                     explained.has(all.effects[e]->name()));
    return added;
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
    const std::vector<char> is_added = added_numbers(explained);
    std::vector<Eigen::Index> added, others;
    for (Eigen::Index c = 0; c < fit.columns.cols(); ++c) (is_added[c] ? added : others).push_back(c);
    Eigen::MatrixXd unknown(fit.columns.rows(), fit.nuisances.columns.cols() + std::ssize(others));
    unknown << fit.nuisances.columns, fit.columns(Eigen::all, others);
    Eigen::VectorXd precisions(unknown.cols());
    precisions << fit.nuisances.precisions, fit.prior_sd(others).cwiseAbs2().cwiseInverse();
    const Whitening V(fit.V->weights(), unknown, precisions);

    const Eigen::MatrixXd S = fit.columns(Eigen::all, added), VS = V.apply(S);
    Eigen::MatrixXd M = S.transpose() * VS;
    M.diagonal() += fit.prior_sd(added).cwiseAbs2().cwiseInverse();
    const Eigen::MatrixXd G = VS.transpose() * corrections_of_probes(problem);
    const Eigen::MatrixXd Q = G.transpose() * M.ldlt().solve(G);
    const double largest =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Q, Eigen::EigenvaluesOnly).eigenvalues()[Q.rows() - 1];
    return 0.5 * share * share * (Q.trace() + 2 * Q.norm() * std::sqrt(rarity) + 2 * largest * rarity);
}

}  // namespace palpate::identify
