#include "identify/fit/markov_field.h"

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

/// The diagonal of (L L^T)^-1, from the last column on, each by the entries of those behind it that L has:
///   Z_ij = delta_ij / L_jj^2 - sum_(k > j) L_kj Z_ik / L_jj. [Takahashi, Fagan, Chin 1973]
Eigen::VectorXd diagonal_of_inverse(const Sparse& L) {
    const auto n = L.cols();
    Sparse Z = L;  // the same entries
    Eigen::VectorXd column = Eigen::VectorXd::Zero(n), sum = Eigen::VectorXd::Zero(n);
    for (Eigen::Index j = n - 1; j >= 0; --j) {
        // sums over k of the entries (i, k), k from this column's own; each stands in the column of the smaller index
        const auto first = L.outerIndexPtr()[j], last = L.outerIndexPtr()[j + 1];
        const int* rows = L.innerIndexPtr();
        const double* values = L.valuePtr();
        for (auto at = first + 1; at < last; ++at) column[rows[at]] = values[at];
        for (auto at = first + 1; at < last; ++at) {
            const int k = rows[at];
            for (Sparse::InnerIterator z(Z, k); z; ++z) {
                sum[z.row()] += values[at] * z.value();
                if (z.row() != k) sum[k] += column[z.row()] * z.value();
            }
        }
        double diagonal = 1 / (values[first] * values[first]);
        for (auto at = first + 1; at < last; ++at) {
            Z.valuePtr()[at] = -sum[rows[at]] / values[first];
            diagonal -= values[at] * Z.valuePtr()[at] / values[first];
        }
        Z.valuePtr()[first] = diagonal;

        for (auto at = first + 1; at < last; ++at) {
            for (Sparse::InnerIterator z(Z, rows[at]); z; ++z) sum[z.row()] = 0;
            column[rows[at]] = 0;
        }
    }
    return Z.diagonal();
}

}  // namespace

MarkovField::MarkovField(const Sparse& precision)
    : Q_(precision), llt_(Q_), d_(Eigen::VectorXd::Ones(precision.rows())) {
    if (llt_.info() != Eigen::Success)
        throw SolverFailure("the precision of a Gaussian field is not positive definite");
}

MarkovField::MarkovField(int n, const std::vector<Edge>& edges, double own) : MarkovField(precision_of(n, edges, own)) {
    const Sparse L = llt_.matrixL();
    const Eigen::VectorXd variances = llt_.permutationPinv() * diagonal_of_inverse(L);
    d_ = variances.cwiseSqrt();
}

Sparse MarkovField::precision() const { return d_.asDiagonal() * Q_ * d_.asDiagonal(); }

Eigen::MatrixXd MarkovField::coloured(const Eigen::MatrixXd& V) const {
    return d_.cwiseInverse().asDiagonal() * (llt_.permutationPinv() * llt_.matrixU().solve(V)).eval();
}

Eigen::MatrixXd MarkovField::transposed(const Eigen::MatrixXd& X) const {
    const Eigen::MatrixXd scaled = d_.cwiseInverse().asDiagonal() * X;
    return llt_.matrixL().solve((llt_.permutationP() * scaled).eval());
}

Eigen::MatrixXd MarkovField::whitened(const Eigen::MatrixXd& X) const {
    const Eigen::MatrixXd scaled = d_.asDiagonal() * X;
    return llt_.matrixU() * (llt_.permutationP() * scaled).eval();
}

double MarkovField::log_root() const {
    return -llt_.matrixL().nestedExpression().diagonal().array().log().sum() - d_.array().log().sum();
}

}  // namespace palpate::identify
