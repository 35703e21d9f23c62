#pragma once

#include <memory>

#include "fem/solve/multigrid/block_matrix.h"

namespace palpate::fem {

/// The coarsest level, solved directly.
class Bottom {
public:
    /// @throws SolverFailure when A is singular to rounding.
    explicit Bottom(const BlockMatrix<6, 6>& A);
    /// x = A^-1 f; unknowns that nothing holds come out as they went in.
    void solve(const Block& f, Block& x) const;

private:
    std::vector<int> position_;  // of each node in the order of elimination
    std::unique_ptr<Cholesky> factor_;
};

}  // namespace palpate::fem
