#include "fem/linear_algebra/conjugate_gradients.h"

#include <fmt/format.h>

#include "fem/linear_algebra/blocks/vectors.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

/// a / b, and 0 for columns that nothing loads.
Row ratio(const Row& a, const Row& b) { return (b > 0).select(a / b, 0.0); }

[[noreturn]] void fail(const std::string& how) {
    throw SolverFailure(
        how +
        " A part of the body may hang on the rest by one edge or corner only, be held too little, or have elements "
        "that are almost flat: repair or remesh the surface there, or allow more memory for a direct "
        "factor.");
}

/// Where A is singular to rounding the preconditioner's own rounding looks like a solution.
void check(const BlockMatrix<3, 3>& A, const MultiVector& X, MultiVector F) {
    constexpr double singular = 1e-4;  // slender bodies leave 1e-7
    const Row loads = dots(F, F);
    multiply(A, X, F, Join::subtract);
    const double left = std::sqrt(ratio(dots(F, F), loads).maxCoeff());
    if (!(left <= singular)) {
        fail(fmt::format("Conjugate gradients found no equilibrium: relative residual {:.1e}.", left));
    }
}

}  // namespace

int conjugate_gradients(const Multigrid& M, MultiVector& X, const ConjugateGradientsOptions& options) {
    const MultiVector F = std::move(X);
    X = MultiVector::Zero(F.rows(), F.cols());
    MultiVector r = F, z, spent = F;
    M.apply(spent, z);
    MultiVector p = z, Ap(F.rows(), F.cols());
    Row rz = dots(r, z);
    const Row least = options.tolerance * options.tolerance * rz;
    auto ended = (rz <= least).eval();
    int k = 0;
    for (; !ended.all(); ++k) {
        if (options.truncated && k == options.iterations) break;
        if (k == options.iterations || !rz.isFinite().all()) {
            fail(
                fmt::format("Conjugate gradients stopped after {} iterations with an error of {:.1e} of the "
                            "displacements' energy norm ({:.0e} asked for).",
                            k, std::sqrt(ratio(rz, least).maxCoeff()) * options.tolerance, options.tolerance));
        }
        multiply(M.matrix(), p, Ap);
        const Row curvature = dots(p, Ap);
        if (options.truncated) {
            for (Eigen::Index j = 0; k == 0 && j < X.cols(); ++j)
                if (!ended(j) && !(curvature(j) > 0)) X.col(j) = p.col(j);
            ended = ended || !(curvature > 0);
        }
        const Row alpha = ratio(ended.select(0.0, rz), curvature);
        add_scaled(p, alpha, X);
        add_scaled(Ap, -alpha, r);
        spent = r;
        M.apply(spent, z);
        const Row next = dots(r, z);
        scale_and_add(z, ratio(next, rz), p);
        rz = next;
        ended = ended || rz <= least;
    }
    if (options.truncated) return k;
    check(M.matrix(), X, F);
    return k;
}

}  // namespace palpate::fem
