#include "identify/inference/domains/force/force_domain.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "identify/numerics/quadratic_forms.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

ForceStatistics zero_statistics(int P) { return {Eigen::SparseMatrix<double>(P, P), Eigen::VectorXd::Zero(P), 0, 0}; }

void accumulate(ForceStatistics& statistics, const Eigen::SparseMatrix<double>& A, const Eigen::VectorXd& f) {
    statistics.H += Eigen::SparseMatrix<double>(A.transpose() * A);
    statistics.g += A.transpose() * f;
    statistics.c += f.squaredNorm();
    statistics.rows += static_cast<int>(f.size());
}

double mean_link_length(const skeleton::Model& model) {
    double sum = 0;
    for (const skeleton::Link& link : model.links) sum += link.length;
    return sum / static_cast<double>(model.links.size());
}

/// Picks the rows of the free spheres, their forces or their torques, times `factor` (rows x 6N).
Eigen::SparseMatrix<double> pick_free(const skeleton::Model& model, bool torques, double factor) {
    std::vector<Eigen::Triplet<double>> entries;
    int row = 0;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (model.spheres[i].held) continue;
        for (int c = 0; c < 3; ++c) entries.emplace_back(row++, 6 * i + (torques ? 3 : 0) + c, factor);
    }
    Eigen::SparseMatrix<double> S(row, model.dofs());
    S.setFromTriplets(entries.begin(), entries.end());
    return S;
}

/// (H + weight) m + g - weight: half the slope of the quadratic and of a prior round 1.
Eigen::VectorXd half_slope(const ForceStatistics& statistics, double weight, const Eigen::VectorXd& m) {
    return statistics.H * m + statistics.g + weight * (m.array() - 1).matrix();
}

/// Where the slope of the free multipliers vanishes, the others at zero.
Eigen::VectorXd unbounded(const ForceStatistics& statistics, double weight, const std::vector<char>& is_free) {
    const auto P = statistics.g.size();
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index p = 0, row = 0; p < P; ++p) {
        if (is_free[p] != 0) entries.emplace_back(row++, p, 1.0);
    }
    Eigen::SparseMatrix<double> S(static_cast<Eigen::Index>(entries.size()), P), I(S.rows(), S.rows());
    S.setFromTriplets(entries.begin(), entries.end());
    I.setIdentity();
    if (S.rows() == 0) return Eigen::VectorXd::Zero(P);
    Eigen::SparseMatrix<double> H = S * statistics.H * S.transpose();
    H += weight * I;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(H);
    if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 0)) {
        throw SolverFailure("some stiffnesses are unobservable from the net forces: no probe moves their links");
    }
    return S.transpose() * ldlt.solve(S * (weight - statistics.g.array()).matrix());
}

}  // namespace

ForceStatistics operator+(const ForceStatistics& a, const ForceStatistics& b) {
    return {a.H + b.H, a.g + b.g, a.c + b.c, a.rows + b.rows};
}

Eigen::VectorXd squared_errors(const ForceStatistics& statistics, const Eigen::MatrixXd& particles) {
    const Eigen::VectorXd quadratic = quadratic_forms(statistics.H, statistics.g, particles);
    return (quadratic.array() + statistics.c).max(0);
}

ForceDomain force_domain(const skeleton::Model& model, const Parameters& parameters,
                         const std::vector<MeasuredConfiguration>& measured) {
    const int P = parameters.size();
    ForceDomain result{zero_statistics(P), zero_statistics(P)};
    const Eigen::SparseMatrix<double> forces = pick_free(model, false, 1),
                                      torques = pick_free(model, true, 1 / mean_link_length(model));

    // k = D m + what stays as it is
    const Eigen::SparseMatrix<double> D = parameters.derivative(parameters.k0);
    const Eigen::VectorXd fixed = parameters.k0 - D * Eigen::VectorXd::Ones(P);

    for (const MeasuredConfiguration& configuration : measured) {
        // r = G k + f_ext = A m + f
        const Eigen::SparseMatrix<double> G = skeleton::link_forces(model, configuration.state), A = G * D;
        const Eigen::VectorXd f = skeleton::external_force(model, configuration.state, configuration.load) +
                                  skeleton::effect_force(model, configuration.state) + G * fixed;
        accumulate(result.forces, forces * A, forces * f);
        accumulate(result.torques, torques * A, torques * f);
    }
    return result;
}

Eigen::VectorXd solve_force_domain(const ForceStatistics& statistics, double prior_share) {
    constexpr int patience = 3;  // exchanges of all that need not better matters, before one at a time
    const auto P = statistics.g.size();
    const double weight = prior_share * statistics.H.diagonal().mean();
    const double rounding = 1e-15 * static_cast<double>(1 + P) * (1 + statistics.g.cwiseAbs().maxCoeff());

    // conditions of Kuhn and Tucker: free multipliers are positive, the slope of those at zero points upwards
    std::vector<char> is_free(static_cast<std::size_t>(P), 1);
    Eigen::Index fewest = P + 1;
    for (int round = 0, left = patience;; ++round) {
        const Eigen::VectorXd m = unbounded(statistics, weight, is_free), slope = half_slope(statistics, weight, m);
        std::vector<Eigen::Index> wrong;
        for (Eigen::Index p = 0; p < P; ++p) {
            if (is_free[p] != 0 ? m[p] < 0 : slope[p] < -rounding) wrong.push_back(p);
        }
        const auto count = static_cast<Eigen::Index>(wrong.size());
        if (count == 0 || round > 10 * P + patience) return m.cwiseMax(0);
        if (count < fewest) {
            fewest = count;
            left = patience;
        } else if (--left < 0) {
            wrong = {wrong.back()};  // the last one alone: ends for certain [Murty 1974]
        }
        for (const Eigen::Index p : wrong) is_free[p] = is_free[p] != 0 ? 0 : 1;
    }
}

}  // namespace palpate::identify
