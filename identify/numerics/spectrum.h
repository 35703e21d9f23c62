#pragma once

#include <Eigen/Core>
#include <functional>

namespace palpate::identify {

/// Leading eigenpairs of a symmetric matrix that is positive semidefinite.
struct Spectrum {
    Eigen::VectorXd values;   // (r), largest first
    Eigen::MatrixXd vectors;  // orthonormal (P x r)
    bool is_whole = true;     // false: the room for it ran out, with eigenvalues left that matter

    /// (shift + V diag(values) V^T)^-1 X: the inverse of the matrix plus a shift > 0, but for the values left out.
    Eigen::MatrixXd inverse(double shift, const Eigen::MatrixXd& X) const;
    /// tr(A (1 + A)^-1): effective number of parameters determined by the data. [MacKay 1992]
    double effective() const { return (values.array() / (1 + values.array())).sum(); }
};

/// A V, of V (P x n).
using SymmetricProduct = std::function<Eigen::MatrixXd(const Eigen::MatrixXd& V)>;

struct SpectrumOptions {
    double least = 0.05;     // of the eigenvalues that are sought
    double residual = 0.05;  // |A v - a v| over a that counts as found
    int exact = 96;          // matrices up to so large are taken apart whole
    int largest = 600;       // subspace at most
};

/// Eigenpairs above `least` by a growing subspace: Rayleigh and Ritz, and from the worst residuals on, a quarter
/// more each time. Without `start` (P x any) from eight random columns, always the same.
Spectrum leading_spectrum(const SymmetricProduct& A, int P, const SpectrumOptions& options = {},
                          const Eigen::MatrixXd& start = {});

}  // namespace palpate::identify
