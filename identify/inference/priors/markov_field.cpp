#include "identify/inference/priors/markov_field.h"

#include <algorithm>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

Sparse precision_of(int n, const std::vector<MarkovField::Edge>& edges, double own) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(n) + 4 * edges.size());
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, own);
    for (const auto& [a, b, weight] : edges) {
        entries.emplace_back(a, a, weight);
        entries.emplace_back(b, b, weight);
        entries.emplace_back(a, b, -weight);
        entries.emplace_back(b, a, -weight);
    }
    Sparse Q(n, n);
    Q.setFromTriplets(entries.begin(), entries.end());
    return Q;
}

/// Each number's neighbours with an index not below its own, ascending.
std::vector<std::vector<int>> lower_neighbours(const Sparse& Q) {
    std::vector<std::vector<int>> lower(static_cast<std::size_t>(Q.cols()));
    for (int i = 0; i < Q.cols(); ++i) {
        std::vector<int>& own = lower[i];
        own.push_back(i);
        for (Sparse::InnerIterator q(Q, i); q; ++q) {
            if (q.row() > i) own.push_back(static_cast<int>(q.row()));
        }
    }
    return lower;
}

}  // namespace

MarkovField::MarkovField(const Sparse& precision) : Q_(precision), d_(Eigen::VectorXd::Ones(precision.rows())) {
    fem::Elimination elimination = fem::analyse(lower_neighbours(Q_), 1);
    order_.indices() = Eigen::Map<const Eigen::VectorXi>(elimination.position.data(), Q_.rows());
    factor_ =
        std::make_unique<fem::Cholesky>(std::make_shared<const fem::Supernodes>(std::move(elimination.supernodes)));
    std::vector<Eigen::Triplet<double, std::int64_t>> entries;
    entries.reserve(Q_.nonZeros());
    for (Eigen::Index i = 0; i < Q_.cols(); ++i) {
        for (Sparse::InnerIterator q(Q_, i); q; ++q) {
            const int row = order_.indices()[q.row()], column = order_.indices()[i];
            if (row >= column) entries.emplace_back(row, column, q.value());
        }
    }
    fem::LowerMatrix ordered(Q_.rows(), Q_.cols());
    ordered.setFromTriplets(entries.begin(), entries.end());
    if (!factor_->factor(ordered, 0)) throw SolverFailure("the precision of a Gaussian field is not positive definite");
}

MarkovField::MarkovField(int n, const std::vector<Edge>& edges, double own) : MarkovField(precision_of(n, edges, own)) {
    d_ = (order_.inverse() * factor_->inverse_diagonal()).cwiseSqrt();
}

Sparse MarkovField::precision() const { return d_.asDiagonal() * Q_ * d_.asDiagonal(); }

Eigen::VectorXd MarkovField::precision_times(const Eigen::VectorXd& X) const {
    return d_.cwiseProduct(Q_ * d_.cwiseProduct(X));
}

Eigen::MatrixXd MarkovField::coloured(const Eigen::MatrixXd& V) const {
    fem::MultiVector X = V;
    factor_->solve_upper(X);
    return d_.cwiseInverse().asDiagonal() * (order_.inverse() * X).eval();
}

Eigen::MatrixXd MarkovField::transposed(const Eigen::MatrixXd& X) const {
    fem::MultiVector solved = order_ * (d_.cwiseInverse().asDiagonal() * X).eval();
    factor_->solve_lower(solved);
    return solved;
}

Eigen::MatrixXd MarkovField::whitened(const Eigen::MatrixXd& X) const {
    // L^T = L^-1 P Q P^T
    fem::MultiVector solved = order_ * (Q_ * (d_.asDiagonal() * X).eval()).eval();
    factor_->solve_lower(solved);
    return solved;
}

double MarkovField::log_root() const { return -factor_->log_root() - d_.array().log().sum(); }

}  // namespace palpate::identify
