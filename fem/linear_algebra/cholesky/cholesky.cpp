#include "fem/linear_algebra/cholesky/cholesky.h"

#include <cblas.h>
#include <fmt/format.h>

#include <cmath>
#include <new>
#include <vector>

#include "fem/linear_algebra/cholesky/factorise.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

/// Smallest over largest pivot; pivots are the squares on the diagonal of L.
double pivot_ratio(const Supernodes& structure, const double* values) {
    double smallest = INFINITY, largest = 0;
    for (int s = 0; s < structure.count(); ++s) {
        for (int c = 0; c < structure.columns(s); ++c) {
            const double diagonal = values[structure.first_value[s] + c * (structure.height(s) + std::int64_t(1))];
            smallest = std::min(smallest, diagonal);
            largest = std::max(largest, diagonal);
        }
    }
    return smallest * smallest / (largest * largest);
}

// A product of matrices copies both first; for one right-hand side, L is gone through as it lies.

void solve_lower_one(const Supernodes& structure, const double* values, int tallest, double* x) {
    Eigen::VectorXd gathered = Eigen::VectorXd::Zero(tallest);
    for (int s = 0; s < structure.count(); ++s) {
        const int n = structure.columns(s), height = structure.height(s);
        const auto below = structure.rows_below(s);
        const double* L = values + structure.first_value[s];
        double* x1 = x + structure.first_column[s];
        cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, n, L, height, x1, 1);
        if (below.empty()) continue;
        cblas_dgemv(CblasColMajor, CblasNoTrans, height - n, n, 1.0, L + n, height, x1, 1, 0.0, gathered.data(), 1);
        for (std::size_t k = 0; k < below.size(); ++k) x[below[k]] -= gathered[static_cast<Eigen::Index>(k)];
    }
}

void solve_upper_one(const Supernodes& structure, const double* values, int tallest, double* x) {
    Eigen::VectorXd gathered = Eigen::VectorXd::Zero(tallest);
    for (int s = structure.count(); s-- > 0;) {
        const int n = structure.columns(s), height = structure.height(s);
        const auto below = structure.rows_below(s);
        const double* L = values + structure.first_value[s];
        double* x1 = x + structure.first_column[s];
        if (!below.empty()) {
            for (std::size_t k = 0; k < below.size(); ++k) gathered[static_cast<Eigen::Index>(k)] = x[below[k]];
            cblas_dgemv(CblasColMajor, CblasTrans, height - n, n, -1.0, L + n, height, gathered.data(), 1, 1.0, x1, 1);
        }
        cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, n, L, height, x1, 1);
    }
}

}  // namespace

Cholesky::Cholesky(std::shared_ptr<const Supernodes> structure) : structure_(std::move(structure)) {
    for (int s = 0; s < structure_->count(); ++s) tallest_ = std::max(tallest_, structure_->height(s));
    try {
        values_ = std::make_unique_for_overwrite<double[]>(structure_->first_value.back());
    } catch (const std::bad_alloc&) {
        throw SolverFailure(
            fmt::format("The factor of the stiffness matrix ({} unknowns) needs {:.1f} GB, which memory does not hold. "
                        "Take a coarser mesh.",
                        structure_->size(), entries() * 8e-9));
    }
}

Cholesky::Cholesky(std::shared_ptr<const Supernodes> structure, const LowerMatrix& K) : Cholesky(std::move(structure)) {
    if (!factor(K)) {
        throw SolverFailure(
            "The stiffness matrix is singular: a part of the body can move without resistance. Does it hang on the "
            "rest by one edge or corner only? Repair the surface there, or hold the part.");
    }
}

bool Cholesky::factor(const LowerMatrix& K, double singular) {
    // The parallel work is ours; BLAS's own threads would get in its way.
    openblas_set_num_threads(1);
    return factorise(*structure_, K, values_.get()) && pivot_ratio(*structure_, values_.get()) > singular;
}

void Cholesky::solve(MultiVector& X) const {
    solve_lower(X);
    solve_upper(X);
}

void Cholesky::solve_lower(MultiVector& X) const {
    if (X.cols() == 0) return;  // of which BLAS complains on standard output
    openblas_set_num_threads(1);
    const auto p = static_cast<int>(X.cols());
    if (p == 1) return solve_lower_one(*structure_, values_.get(), tallest_, X.data());
    // In groups of loads, so that neighbouring ones pass over what none of them reaches.
    constexpr int together = 64;
    const int groups = (p + together - 1) / together;
    MultiVector gathered(tallest_, together);
    for (int g = 0; g < groups; ++g) {
        const int begin = p * g / groups, end = p * (g + 1) / groups;
        solve_lower(X.middleCols(begin, end - begin), gathered);
    }
}

void Cholesky::solve_lower(Eigen::Ref<MultiVector> X, MultiVector& gathered) const {
    // X1 <- L11^-1 X1, then X2 <- X2 - L21 X1. BLAS counts by columns and sees X transposed.
    const auto p = static_cast<int>(X.cols()), stride = static_cast<int>(X.outerStride());
    for (int s = 0; s < structure_->count(); ++s) {
        const int n = structure_->columns(s), height = structure_->height(s);
        const auto below = structure_->rows_below(s);
        const double* L = values_.get() + structure_->first_value[s];
        if (X.middleRows(structure_->first_column[s], n).isZero(0)) continue;
        double* X1 = X.row(structure_->first_column[s]).data();
        cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, p, n, 1.0, L, height, X1, stride);
        if (below.empty()) continue;
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, p, height - n, n, 1.0, X1, stride, L + n, height, 0.0,
                    gathered.data(), p);
        for (std::size_t k = 0; k < below.size(); ++k) {
            X.row(below[k]) -= Eigen::Map<const Eigen::RowVectorXd>(gathered.data() + k * p, p);
        }
    }
}

void Cholesky::solve_upper(MultiVector& X) const {
    if (X.cols() == 0) return;
    openblas_set_num_threads(1);
    const auto p = static_cast<int>(X.cols());
    if (p == 1) return solve_upper_one(*structure_, values_.get(), tallest_, X.data());
    MultiVector gathered(tallest_, p);
    // X1 <- L11^-T (X1 - L21^T X2)
    for (int s = structure_->count(); s-- > 0;) {
        const int n = structure_->columns(s), height = structure_->height(s);
        const auto below = structure_->rows_below(s);
        const double* L = values_.get() + structure_->first_value[s];
        double* X1 = X.row(structure_->first_column[s]).data();
        if (!below.empty()) {
            for (std::size_t k = 0; k < below.size(); ++k) gathered.row(k) = X.row(below[k]);
            cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, p, n, height - n, -1.0, gathered.data(), p, L + n,
                        height, 1.0, X1, p);
        }
        cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, p, n, 1.0, L, height, X1, p);
    }
}

double Cholesky::log_root() const {
    double sum = 0;
    for (int s = 0; s < structure_->count(); ++s) {
        const double* L = values_.get() + structure_->first_value[s];
        for (int c = 0; c < structure_->columns(s); ++c)
            sum += std::log(L[c * (structure_->height(s) + std::int64_t{1})]);
    }
    return sum;
}

Eigen::VectorXd Cholesky::inverse_diagonal() const {
    // Z = (L L^T)^-1 from the last columns J on, by the entries of those behind them that L has, R:
    //   Z_RJ = -Z_RR Y,  Z_JJ = (L_JJ L_JJ^T)^-1 + Y^T Z_RR Y,  Y = L_RJ L_JJ^-1. [Takahashi, Fagan, Chin 1973]
    using Dense = Eigen::MatrixXd;
    using Columns = Eigen::Map<const Dense, 0, Eigen::OuterStride<>>;
    std::vector<int> supernode_of(structure_->size());
    std::vector<Dense> Z(structure_->count());                // as L's supernodes lie
    std::vector<Eigen::Index> place(structure_->size(), -1);  // among R
    Eigen::VectorXd diagonal(structure_->size());
    for (int s = structure_->count(); s-- > 0;) {
        const int own = structure_->columns(s), height = structure_->height(s), below = height - own;
        const int first = structure_->first_column[s];
        std::fill_n(supernode_of.begin() + first, own, s);
        const auto R = structure_->rows_below(s);
        const Columns L(values_.get() + structure_->first_value[s], height, own, Eigen::OuterStride<>(height));
        const auto L_JJ = L.topRows(own).triangularView<Eigen::Lower>();

        for (int a = 0; a < below; ++a) place[R[a]] = a;
        Dense Z_RR(below, below);
        for (int a = 0; a < below; ++a) {
            const int t = supernode_of[R[a]], column = R[a] - structure_->first_column[t];
            const auto rows = structure_->rows_of(t);
            for (int k = column; k < structure_->height(t); ++k) {
                const Eigen::Index b = place[rows[k]];
                if (b >= 0) Z_RR(a, b) = Z_RR(b, a) = Z[t](k, column);
            }
        }
        for (int a = 0; a < below; ++a) place[R[a]] = -1;

        const Dense Y = L_JJ.solve<Eigen::OnTheRight>(L.bottomRows(below));
        const Dense root = L_JJ.solve(Dense::Identity(own, own));
        Z[s].resize(height, own);
        Z[s].bottomRows(below).noalias() = -Z_RR * Y;
        Z[s].topRows(own).noalias() = root.transpose() * root - Y.transpose() * Z[s].bottomRows(below);
        diagonal.segment(first, own) = Z[s].topRows(own).diagonal();
    }
    return diagonal;
}

}  // namespace palpate::fem
