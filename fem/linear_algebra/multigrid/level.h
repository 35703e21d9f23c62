#pragma once

#include "fem/linear_algebra/multigrid/chebyshev.h"
#include "fem/linear_algebra/multigrid/prolongator.h"

namespace palpate::fem {

/// A matrix, what smooths its errors, and the way to the next coarser level; in single precision, for a preconditioner
/// is approximate anyway.
template <int b>
struct Level {
    BlockMatrix<b, b, float> A;
    Chebyshev<b> smoother;
    BlockMatrix<b, 6, float> prolongation;
    BlockMatrix<6, b, float> restriction;  // its transpose
};

/// A level, and what is on the next.
template <int b>
struct Coarsened {
    Level<b> level;
    BlockMatrix<6, 6> A;  // prolongation^T A prolongation
    RigidModes modes;
};

/// `strength`: least of a strong connection. @throws SolverFailure when A is singular to rounding.
template <int b>
Coarsened<b> coarsen(const BlockMatrix<b, b>& A, const RigidModes& modes, double strength);

extern template Coarsened<3> coarsen(const BlockMatrix<3, 3>&, const RigidModes&, double);
extern template Coarsened<6> coarsen(const BlockMatrix<6, 6>&, const RigidModes&, double);

}  // namespace palpate::fem
