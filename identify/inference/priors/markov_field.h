#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "fem/linear_algebra/cholesky/cholesky.h"

namespace palpate::identify {

/// A Gaussian Markov random field: n numbers of mean 0 and a sparse precision D Q D, D diagonal. Given the rest, a
/// number depends on its neighbours alone. [Rue & Held 2005, ch. 2]
///
/// x = C v is such a field where v ~ N(0, 1), C = D^-1 P^T L^-T with the sparse Cholesky factor P Q P^T = L L^T.
class MarkovField {
public:
    /// Of that precision, symmetric and positive definite (n x n). @throws SolverFailure when it is not.
    explicit MarkovField(const Eigen::SparseMatrix<double>& precision);

    struct Edge {
        int a, b;
        double weight;
    };
    /// Of variance 1, alike where numbers are joined: Q = own + the edges' Laplacian, and D such that all variances
    /// are 1. On a chain of weights 1 the correlation falls as exp(-acosh(1 + own / 2)) a step. @pre own > 0, weights
    /// >= 0.
    MarkovField(int n, const std::vector<Edge>& edges, double own);

    Eigen::MatrixXd coloured(const Eigen::MatrixXd& V) const;         // C V (n x any)
    Eigen::MatrixXd transposed(const Eigen::MatrixXd& X) const;       // C^T X
    Eigen::MatrixXd whitened(const Eigen::MatrixXd& X) const;         // C^-1 X
    Eigen::VectorXd precision_times(const Eigen::VectorXd& X) const;  // D Q D X
    double log_root() const;                                          // ln |det C|
    Eigen::SparseMatrix<double> precision() const;                    // D Q D

private:
    Eigen::SparseMatrix<double> Q_;
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order_;  // P, of the elimination
    std::unique_ptr<fem::Cholesky> factor_;
    Eigen::VectorXd d_;  // D (n)
};

}  // namespace palpate::identify
