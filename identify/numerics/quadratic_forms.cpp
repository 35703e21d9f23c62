#include "identify/numerics/quadratic_forms.h"

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
        Eigen::MatrixXd jacobian = X.middleRows(begin, count);
        cblas_dtrmm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, count, P, 1, T.data(), P,
                    jacobian.data(), count);
        jacobian.rowwise() += g.transpose();
        forms.segment(begin, count) = 2 * jacobian.cwiseProduct(X.middleRows(begin, count)).rowwise().sum();
    }
    return forms;
}

using Eight = double __attribute__((vector_size(64)));
// A typedef: from an alias Clang takes no alignment.
typedef double EightInMemory __attribute__((vector_size(64), aligned(8), may_alias));

PALPATE_INLINE Eight load(const double* p) { return *reinterpret_cast<const EightInMemory*>(p); }
PALPATE_INLINE void store(Eight v, double* p) { *reinterpret_cast<EightInMemory*>(p) = v; }

constexpr int width = 32;     // particles in a strip
constexpr int in_hand = 8;    // numbers of a particle that registers hold
constexpr int of_hands = 16;  // particles at once, of so few

/// forms[i] = 2 sum_a x_ia (g_a + sum_b<=a T_ba x_ib) of all particles, a multiple of `of_hands`; x_ia at
/// x[a * stride + i], T_ba at T[a * P + b].
template <int P>
PALPATE_INLINE void forms_of_few(const double* T, const double* g, const double* x, Eigen::Index stride,
                                 Eigen::Index particles, double* forms) {
    for (Eigen::Index i = 0; i < particles; i += of_hands) {
        Eight own[P][2], sum[2] = {};
#pragma GCC unroll 8
        for (int a = 0; a < P; ++a) {
#pragma GCC unroll 8
            for (int v = 0; v < 2; ++v) own[a][v] = load(x + a * stride + i + 8 * v);
        }
#pragma GCC unroll 8
        for (int a = 0; a < P; ++a) {
#pragma GCC unroll 8
            for (int v = 0; v < 2; ++v) {
                Eight slope = g[a] + T[a * P] * own[0][v];
#pragma GCC unroll 8
                for (int b = 1; b <= a; ++b) slope += T[a * P + b] * own[b][v];
                sum[v] += slope * own[a][v];
            }
        }
        for (int v = 0; v < 2; ++v) store(2 * sum[v], forms + i + 8 * v);
    }
}

PALPATE_CLONES void few_forms(int P, const double* T, const double* g, const double* x, Eigen::Index stride,
                              Eigen::Index particles, double* forms) {
    switch (P) {
        case 1:
            return forms_of_few<1>(T, g, x, stride, particles, forms);
        case 2:
            return forms_of_few<2>(T, g, x, stride, particles, forms);
        case 3:
            return forms_of_few<3>(T, g, x, stride, particles, forms);
        case 4:
            return forms_of_few<4>(T, g, x, stride, particles, forms);
        case 5:
            return forms_of_few<5>(T, g, x, stride, particles, forms);
        case 6:
            return forms_of_few<6>(T, g, x, stride, particles, forms);
        case 7:
            return forms_of_few<7>(T, g, x, stride, particles, forms);
        case 8:
            return forms_of_few<8>(T, g, x, stride, particles, forms);
    }
}

Eigen::VectorXd forms_in_hand(const Eigen::SparseMatrix<double>& half, const Eigen::VectorXd& g,
                              const Eigen::MatrixXd& X) {
    const Eigen::MatrixXd T = half;
    const auto P = static_cast<int>(X.cols());
    const Eigen::Index N = X.rows(), whole = N - N % of_hands;
    Eigen::VectorXd forms(N);
    few_forms(P, T.data(), g.data(), X.data(), N, whole, forms.data());
    if (whole < N) {
        Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(of_hands, P);
        Eigen::VectorXd of_rest(of_hands);
        rest.topRows(N - whole) = X.bottomRows(N - whole);
        few_forms(P, T.data(), g.data(), rest.data(), of_hands, of_hands, of_rest.data());
        forms.tail(N - whole) = of_rest.head(N - whole);
    }
    return forms;
}

/// The entries of T's columns, and of each column whether the next one has the same rows but for one more, its own.
struct Entries {
    const int *start, *row;
    const double* value;
    Eigen::Index columns;
    const char* has_twin;
};

/// The same of a strip. Twins are gone through together: what is loaded serves both.
PALPATE_CLONES void strip_forms(const Entries& T, const double* g, const double* x, Eigen::Index stride,
                                double* forms) {
    Eight sum[4] = {};
    for (Eigen::Index a = 0; a < T.columns; ++a) {
        const double* own = x + a * stride;
        const int begin = T.start[a], end = T.start[a + 1];
        Eight slope[4] = {};
        if (T.has_twin[a]) {
            Eight of_twin[4] = {};
            for (int n = begin; n < end; ++n) {
                const double* other = x + T.row[n] * stride;
                const double A = T.value[n], B = T.value[n + end - begin];
                for (int v = 0; v < 4; ++v) {
                    const Eight at = load(other + 8 * v);
                    slope[v] += A * at;
                    of_twin[v] += B * at;
                }
            }
            const double* twin = own + stride;
            const double last = T.value[T.start[a + 2] - 1];
            for (int v = 0; v < 4; ++v) {
                const Eight at = load(twin + 8 * v);
                sum[v] += (slope[v] + g[a]) * load(own + 8 * v) + (of_twin[v] + last * at + g[a + 1]) * at;
            }
            ++a;
            continue;
        }
        for (int n = begin; n < end; ++n) {
            const double* other = x + T.row[n] * stride;
            for (int v = 0; v < 4; ++v) slope[v] += T.value[n] * load(other + 8 * v);
        }
        for (int v = 0; v < 4; ++v) sum[v] += (slope[v] + g[a]) * load(own + 8 * v);
    }
    for (int v = 0; v < 4; ++v) store(2 * sum[v], forms + 8 * v);
}

std::vector<char> twins(const Eigen::SparseMatrix<double>& T) {
    const int *start = T.outerIndexPtr(), *row = T.innerIndexPtr();
    std::vector<char> has(static_cast<std::size_t>(T.cols()), 0);
    for (Eigen::Index a = 0; a + 1 < T.cols(); ++a) {
        if (a > 0 && has[a - 1]) continue;
        const int count = start[a + 1] - start[a];
        has[a] = start[a + 2] - start[a + 1] == count + 1 && row[start[a + 2] - 1] == a + 1 &&
                 std::equal(row + start[a], row + start[a + 1], row + start[a + 1]);
    }
    return has;
}

Eigen::VectorXd sparse_forms(const Eigen::SparseMatrix<double>& half, const Eigen::VectorXd& g,
                             const Eigen::MatrixXd& X) {
    const std::vector<char> has_twin = twins(half);
    const Entries T{half.outerIndexPtr(), half.innerIndexPtr(), half.valuePtr(), half.cols(), has_twin.data()};
    const Eigen::Index N = X.rows(), P = X.cols();
    Eigen::VectorXd forms(N);
    Eigen::MatrixXd strip = Eigen::MatrixXd::Zero(width, P);
    Eigen::VectorXd of_strip(width);
    for (Eigen::Index begin = 0; begin < N; begin += width) {
        const Eigen::Index count = std::min<Eigen::Index>(width, N - begin);
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
    if (P <= in_hand) return forms_in_hand(half, g, X);
    return dense ? dense_forms(half, g, X) : sparse_forms(half, g, X);
}

}  // namespace palpate::identify
