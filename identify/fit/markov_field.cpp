#include "identify/fit/markov_field.h"

#include <algorithm>

#include "fem/solve/cholesky.h"
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

/// Columns [first, last) of a Cholesky factor with the same rows below them.
struct SameRows {
    Eigen::Index first, last;
};

std::vector<SameRows> groups_of(const Sparse& L) {
    const int *start = L.outerIndexPtr(), *rows = L.innerIndexPtr();
    const auto goes_on = [&](Eigen::Index j) {  // as column j did: the next one is its parent, and adds no row
        const int count = start[j + 1] - start[j];
        return count > 1 && rows[start[j] + 1] == j + 1 && start[j + 2] - start[j + 1] == count - 1;
    };
    std::vector<SameRows> groups;
    for (Eigen::Index j = 0; j < L.cols(); ++j) {
        if (j > 0 && goes_on(j - 1)) {
            ++groups.back().last;
        } else {
            groups.push_back({j, j + 1});
        }
    }
    return groups;
}

/// The diagonal of Z = (L L^T)^-1, from the last columns J on, by the entries of those behind them that L has, R:
///   Z_RJ = -Z_RR Y,  Z_JJ = (L_JJ L_JJ^T)^-1 + Y^T Z_RR Y,  Y = L_RJ L_JJ^-1. [Takahashi, Fagan, Chin 1973]
Eigen::VectorXd diagonal_of_inverse(const Sparse& L) {
    using Dense = Eigen::MatrixXd;
    Sparse Z = L;  // the same entries
    const int *start = L.outerIndexPtr(), *rows = L.innerIndexPtr();
    std::vector<Eigen::Index> place(static_cast<std::size_t>(L.cols()), -1);  // among R
    const std::vector<SameRows> groups = groups_of(L);
    for (auto group = groups.rbegin(); group != groups.rend(); ++group) {
        const auto [first, last] = *group;
        const Eigen::Index own = last - first, below = start[last] - start[last - 1] - 1;
        const int* const R = rows + start[last - 1] + 1;
        Dense of_L = Dense::Zero(own + below, own);
        for (Eigen::Index c = 0; c < own; ++c) {
            std::copy_n(L.valuePtr() + start[first + c], own - c + below, &of_L(c, c));
        }
        const auto L_JJ = of_L.topRows(own).triangularView<Eigen::Lower>();

        for (Eigen::Index a = 0; a < below; ++a) place[R[a]] = a;
        Dense Z_RR(below, below);
        for (Eigen::Index a = 0; a < below; ++a) {
            for (Sparse::InnerIterator z(Z, R[a]); z; ++z) {
                const Eigen::Index b = place[z.row()];
                if (b >= 0) Z_RR(a, b) = Z_RR(b, a) = z.value();
            }
        }
        for (Eigen::Index a = 0; a < below; ++a) place[R[a]] = -1;

        const Dense Y = L_JJ.solve<Eigen::OnTheRight>(of_L.bottomRows(below));
        const Dense root = L_JJ.solve(Dense::Identity(own, own));
        Dense of_Z(own + below, own);
        of_Z.bottomRows(below).noalias() = -Z_RR * Y;
        of_Z.topRows(own).noalias() = root.transpose() * root - Y.transpose() * of_Z.bottomRows(below);
        for (Eigen::Index c = 0; c < own; ++c) {
            std::copy_n(&of_Z(c, c), own - c + below, Z.valuePtr() + start[first + c]);
        }
    }
    return Z.diagonal();
}

/// X <- L^-1 X, all columns at once.
void solve_lower(const Sparse& L, fem::Block& X) {
    for (Eigen::Index j = 0; j < L.cols(); ++j) {
        Sparse::InnerIterator at(L, j);
        X.row(j) /= at.value();
        while (++at) X.row(at.row()) -= at.value() * X.row(j);
    }
}

/// X <- L^-T X, the same.
void solve_upper(const Sparse& L, fem::Block& X) {
    for (Eigen::Index j = L.cols() - 1; j >= 0; --j) {
        Sparse::InnerIterator at(L, j);
        const double diagonal = at.value();
        while (++at) X.row(j) -= at.value() * X.row(at.row());
        X.row(j) /= diagonal;
    }
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
    fem::Block X = V;
    solve_upper(llt_.matrixL().nestedExpression(), X);
    return d_.cwiseInverse().asDiagonal() * (llt_.permutationPinv() * X).eval();
}

Eigen::MatrixXd MarkovField::transposed(const Eigen::MatrixXd& X) const {
    const fem::Block scaled = d_.cwiseInverse().asDiagonal() * X;
    fem::Block solved = llt_.permutationP() * scaled;
    solve_lower(llt_.matrixL().nestedExpression(), solved);
    return solved;
}

Eigen::MatrixXd MarkovField::whitened(const Eigen::MatrixXd& X) const {
    const Eigen::MatrixXd scaled = d_.asDiagonal() * X;
    return llt_.matrixU() * (llt_.permutationP() * scaled).eval();
}

double MarkovField::log_root() const {
    return -llt_.matrixL().nestedExpression().diagonal().array().log().sum() - d_.array().log().sum();
}

}  // namespace palpate::identify
