#pragma once

#include <memory>

#include "fem/linear_algebra/multigrid/prolongator.h"

namespace palpate::fem {

struct MultigridOptions {
    double strength =
        0.03;  // least of a strong connection on the finest level, [0, 1); half as much on each coarser one
    int coarsest_nodes = 700;  // so few are solved for directly
};

/// An approximate inverse of a body's stiffness matrix: smoothed aggregation with rigid-body modes. [Vanek, Mandel &
/// Brezina 1996] Symmetric and positive definite, so that conjugate gradients can use it.
class Multigrid {
public:
    /// `modes`: of A's unknowns. @throws SolverFailure when A is singular to rounding.
    Multigrid(BlockMatrix<3, 3> A, const RigidModes& modes, const MultigridOptions& options = {});
    ~Multigrid();
    Multigrid(Multigrid&&) noexcept;

    /// x = M f by one V-cycle; `f` is spent.
    void apply(MultiVector& f, MultiVector& x) const;

    const BlockMatrix<3, 3>& matrix() const;
    int levels() const;         // the finest and the one that is solved directly included
    double complexity() const;  // entries of all levels' matrices over those of the finest

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
