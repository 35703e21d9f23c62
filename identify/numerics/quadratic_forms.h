#pragma once

#include <Eigen/SparseCore>

namespace palpate::identify {

/// x^T H x + 2 g^T x of each row x of X (N x P), H symmetric (P x P): many particles at once.
///
/// One triangle of H is enough, H = T + T^T with half of the diagonal in T: x^T H x = 2 x^T T x. Where H is large and
/// dense, X T is a product of matrices, for half of what X H takes; else the entries of T are gone through once for a
/// strip of particles that lie side by side, in the vector units' lanes.
Eigen::VectorXd quadratic_forms(const Eigen::SparseMatrix<double>& H, const Eigen::VectorXd& g,
                                const Eigen::MatrixXd& X);

}  // namespace palpate::identify
