#include "identify/fit/quadratic_forms.h"

#include <cblas.h>

#include <algorithm>
#include <vector>

#include "skeleton/lanes.h"

namespace palpate::identify {
namespace {

// with so large a share of H's entries, and so many numbers, it is multiplied as a dense matrix
constexpr double dense_share = 0.1;
constexpr Eigen::Index few = 32;
constexpr Eigen::Index rows_at_once = 1024;  // of particles, in a product that stays in the cache

/// Half of the diagonal and what lies above it.
Eigen::SparseMatrix<double> half_of(const Eigen::SparseMatrix<double>& H) {
    Eigen::SparseMatrix<double> T = H.triangularView<Eigen::Upper>();
    for (Eigen::Index p = 0; p < T.cols(); ++p) T.coeffRef(p, p) *= 0.5;
    T.makeCompressed();
    return T;
}

Eigen::VectorXd dense_forms(const Eigen::SparseMatrix<double>& half, const Eigen::VectorXd& g,
                            const Eigen::MatrixXd& X) {
    const Eigen::MatrixXd T = half;
    const auto P = static_cast<int>(T.rows());
    Eigen::VectorXd forms(X.rows());
    for (Eigen::Index begin = 0; begin < X.rows(); begin += rows_at_once) {
        const auto count = static_cast<int>(std::min(rows_at_once, X.rows() - begin));
        Eigen::MatrixXd slopes = X.middleRows(begin, count);
        cblas_dtrmm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, count, P, 1, T.data(), P,
                    slopes.data(), count);
        slopes.rowwise() += g.transpose();
        forms.segment(begin, count) = 2 * slopes.cwiseProduct(X.middleRows(begin, count)).rowwise().sum();
    }
    return forms;
}

using Eight = double __attribute__((vector_size(64)));
using EightInMemory = double __attribute__((vector_size(64), aligned(8), may_alias));
constexpr int width = 32;  // particles in a strip

PALPATE_INLINE Eight load(const double* p) { return *reinterpret_cast<const EightInMemory*>(p); }

/// The entries of T's columns.
struct Entries {
    const int *start, *row;
    const double* value;
    Eigen::Index columns;
};

/// forms[i] = 2 sum_a x_ia (g_a + sum_b T_ba x_ib) of a strip; x_ia at x[a * stride + i].
PALPATE_CLONES void strip_forms(const Entries& T, const double* g, const double* x, Eigen::Index stride,
                                double* forms) {
    Eight sum[4] = {};
    for (Eigen::Index a = 0; a < T.columns; ++a) {
        Eight slope[4] = {};
        for (int n = T.start[a]; n < T.start[a + 1]; ++n) {
            const double* own = x + T.row[n] * stride;
            for (int v = 0; v < 4; ++v) slope[v] += T.value[n] * load(own + 8 * v);
        }
        const double* own = x + a * stride;
        for (int v = 0; v < 4; ++v) sum[v] += (slope[v] + g[a]) * load(own + 8 * v);
    }
    for (int v = 0; v < 4; ++v) *reinterpret_cast<EightInMemory*>(forms + 8 * v) = 2 * sum[v];
}

Eigen::VectorXd sparse_forms(const Eigen::SparseMatrix<double>& half, const Eigen::VectorXd& g,
                             const Eigen::MatrixXd& X) {
    const Entries T{half.outerIndexPtr(), half.innerIndexPtr(), half.valuePtr(), half.cols()};
    const Eigen::Index N = X.rows(), P = X.cols();
    Eigen::VectorXd forms(N);
    Eigen::MatrixXd strip = Eigen::MatrixXd::Zero(width, P);
    Eigen::VectorXd of_strip(width);
    for (Eigen::Index begin = 0; begin < N; begin += width) {
        const Eigen::Index count = std::min<Eigen::Index>(width, N - begin);
        if (count == width && P <= few) {
            strip_forms(T, g.data(), X.data() + begin, N, forms.data() + begin);
            continue;
        }
        strip.topRows(count) = X.middleRows(begin, count);
        strip_forms(T, g.data(), strip.data(), width, of_strip.data());
        forms.segment(begin, count) = of_strip.head(count);
    }
    return forms;
}

}  // namespace

Eigen::VectorXd quadratic_forms(const Eigen::SparseMatrix<double>& H, const Eigen::VectorXd& g,
                                const Eigen::MatrixXd& X) {
    const auto P = H.rows();
    const bool dense = P > few && static_cast<double>(H.nonZeros()) > dense_share * static_cast<double>(P * P);
    const Eigen::SparseMatrix<double> half = half_of(H);
    return dense ? dense_forms(half, g, X) : sparse_forms(half, g, X);
}

}  // namespace palpate::identify
