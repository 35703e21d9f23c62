#pragma once

#include "fem/linear_algebra/blocks/block_matrix.h"

namespace palpate::fem {

/// The inverses of the diagonal blocks, as a matrix of them alone. Unconstrained unknowns, as those of aggregates too
/// small for all rigid modes, are left unchanged: their rows and columns are zero.
/// @throws SolverFailure where a diagonal block is singular to rounding.
template <int b>
BlockMatrix<b, b> inverse_diagonal(const BlockMatrix<b, b>& A);

/// The largest eigenvalue of D^-1 A, from below, by Lanczos' method from a random start: within some percent.
/// [Golub & Van Loan, section 10.1; its tridiagonal matrix is read off conjugate gradients]
template <int b>
double largest_eigenvalue(const BlockMatrix<b, b>& A, const BlockMatrix<b, b>& inverse_diagonal);

/// A polynomial in D^-1 A that damps the upper part of its spectrum. Symmetric in the energy, and of the same numbers
/// on any number of threads, as Gauss and Seidel's sweeps are not. [Adams, Brezina, Hu & Tuminaro 2003]
template <int b>
class Chebyshev {
public:
    Chebyshev(BlockMatrix<b, b> inverse_diagonal, double largest_eigenvalue);

    /// Improves x, the solution of A x = f; `residual` is f - A x on entry, and on return once more where
    /// `keep_residual`.
    void smooth(const BlockMatrix<b, b, float>& A, MultiVector& x, MultiVector& residual, bool keep_residual) const;

private:
    BlockMatrix<b, b> inverse_diagonal_;
    double middle_, radius_;  // of the part of the spectrum that is damped
};

extern template BlockMatrix<3, 3> inverse_diagonal(const BlockMatrix<3, 3>&);
extern template BlockMatrix<6, 6> inverse_diagonal(const BlockMatrix<6, 6>&);
extern template double largest_eigenvalue(const BlockMatrix<3, 3>&, const BlockMatrix<3, 3>&);
extern template double largest_eigenvalue(const BlockMatrix<6, 6>&, const BlockMatrix<6, 6>&);
extern template class Chebyshev<3>;
extern template class Chebyshev<6>;

}  // namespace palpate::fem
