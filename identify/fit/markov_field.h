#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

namespace palpate::identify {

/// A Gaussian Markov random field: n numbers of mean 0 and variance 1, alike where they are joined. Given the rest, a
/// number depends on its neighbours alone. Its precision is D Q D with Q = own + the edges' Laplacian, and D diagonal,
/// such that all variances are 1. On a chain of weights 1 the correlation falls as exp(-sqrt(own)) a step.
/// [Rue & Held 2005, ch. 2]
///
/// x = C v is such a field where v ~ N(0, 1), C = D^-1 P^T L^-T with the sparse Cholesky factor P Q P^T = L L^T.
class MarkovField {
public:
    struct Edge {
        int a, b;
        double weight;
    };
    /// @pre own > 0, weights >= 0.
    MarkovField(int n, const std::vector<Edge>& edges, double own);

    Eigen::MatrixXd coloured(const Eigen::MatrixXd& V) const;    // C V (n x any)
    Eigen::MatrixXd transposed(const Eigen::MatrixXd& X) const;  // C^T X
    Eigen::MatrixXd whitened(const Eigen::MatrixXd& X) const;    // C^-1 X
    double log_root() const;                                     // ln |det C|

private:
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> llt_;
    Eigen::VectorXd d_;  // D (n)
};

}  // namespace palpate::identify
