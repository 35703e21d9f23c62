#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "identify/fit/solver_pool.h"

namespace palpate::identify {

/// Derivatives J = dd / dtheta of the errors d = (measured - modelled) / sigma at one theta, by its equilibria.
///
/// In equilibrium r(x, k) = f_ext + G k = 0, effects in the links (G) and others (f_ext) included, so dx/dk = T^-1 G
/// with the tangent T = -dr/dx, and a marker moves by P T^-1 G dk/dtheta: exact, for one factorisation a state (linear
/// law: one in all). J^T J (P x P) is not made; its products cost two solves a state and column.
class Slopes {
public:
    /// What a state contributes.
    struct State {
        Eigen::SparseMatrix<double> G;          // dr/dtheta (6N x P)
        Eigen::SparseMatrix<double> PWP;        // readings pulled back to the spheres, P^T W P (6N x 6N)
        Eigen::VectorXd PWe;                    // and their errors, P^T W (measured - modelled) (6N)
        const skeleton::StaticsSolver* solver;  // T, factored
    };
    using Loans = std::vector<std::unique_ptr<SolverPool::Loan>>;

    /// `loans`: the solvers of the states, kept.
    Slopes(std::vector<State> states, Loans loans, int threads)
        : states_(std::move(states)), loans_(std::move(loans)), threads_(threads) {}

    Eigen::VectorXd gradient() const;                                 // of half the chi^2, J^T d (P)
    Eigen::MatrixXd curvature_times(const Eigen::MatrixXd& V) const;  // J^T J V, of V (P x n)

private:
    std::vector<State> states_;
    Loans loans_;
    int threads_;
};

}  // namespace palpate::identify
