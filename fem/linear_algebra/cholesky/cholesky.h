#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <memory>

#include "fem/linear_algebra/cholesky/lower_matrix.h"
#include "fem/linear_algebra/cholesky/supernodes.h"

namespace palpate::fem {

/// Right-hand sides beside each other, those of one unknown together in memory (n x p).
using MultiVector = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// K = L L^T of a sparse positive definite matrix by supernodes.
class Cholesky {
public:
    /// Room for factors of this structure. @throws SolverFailure when memory does not suffice.
    explicit Cholesky(std::shared_ptr<const Supernodes> structure);
    /// @throws SolverFailure when K is singular to rounding, or memory does not suffice.
    Cholesky(std::shared_ptr<const Supernodes> structure, const LowerMatrix& K);

    /// Factors K in place of what was factored before; false, and nothing to solve with, when K is not positive
    /// definite to rounding: a pivot is below `singular` times the largest. Works in parallel over the elimination tree
    /// and over fixed tiles of large supernodes: the same numbers on any number of threads.
    bool factor(const LowerMatrix& K, double singular = 1e-14);

    /// X <- K^-1 X on one thread. Supernodes that a load does not reach are passed over. Safe from several threads.
    void solve(MultiVector& X) const;
    void solve_lower(MultiVector& X) const;  // X <- L^-1 X
    void solve_upper(MultiVector& X) const;  // X <- L^-T X

    double log_root() const;                   // ln det L
    Eigen::VectorXd inverse_diagonal() const;  // of K^-1

    /// Stored entries of the factor.
    double entries() const { return static_cast<double>(structure_->first_value.back()); }

private:
    void solve_lower(Eigen::Ref<MultiVector> X, MultiVector& gathered) const;

    std::shared_ptr<const Supernodes> structure_;
    std::unique_ptr<double[]> values_;
    int tallest_ = 0;  // supernode [rows]
};

}  // namespace palpate::fem
