#pragma once

#include <memory>

#include "fem/linear_algebra/blocks/block_matrix.h"

namespace palpate::fem {

/// The coarsest level, solved directly.
class CoarseSolver {
public:
    /// @throws SolverFailure when A is singular to rounding.
    explicit CoarseSolver(const BlockMatrix<6, 6>& A);
    /// x = A^-1 f; unconstrained unknowns are returned unchanged.
    void solve(const MultiVector& f, MultiVector& x) const;

private:
    std::vector<int> position_;  // of each node in the order of elimination
    std::unique_ptr<Cholesky> factor_;
};

}  // namespace palpate::fem
