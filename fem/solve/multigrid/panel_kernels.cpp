#include "fem/solve/multigrid/panel_kernels.h"

#include "mesh/clones.h"

namespace palpate::fem {

namespace {

constexpr int lanes = 8;
using Lanes = double __attribute__((vector_size(lanes * sizeof(double))));
// In memory they need not be aligned.
using LanesInMemory = double __attribute__((vector_size(lanes * sizeof(double)), aligned(8), may_alias));

PALPATE_INLINE void load(const double* from, Lanes& to) { to = *reinterpret_cast<const LanesInMemory*>(from); }

PALPATE_INLINE void put(double* y, double sum, Join join) {
    *y = join == Join::set ? sum : join == Join::add ? *y + sum : *y - sum;
}

/// Eight columns of X at once: each entry of A meets a vector.
template <int R, int C>
PALPATE_INLINE void multiply_eight(const int* column, const double* panel, std::int64_t width, const double* X, int p,
                                   Join join, double* Y) {
    Lanes sum[R] = {}, x;
    for (std::int64_t k = 0; k < width; k += C) {
        const double* from = X + static_cast<std::int64_t>(C) * *column++ * p;
        for (int c = 0; c < C; ++c) {
            load(from + static_cast<std::int64_t>(c) * p, x);
            for (int r = 0; r < R; ++r) sum[r] += panel[r * width + k + c] * x;
        }
    }
    for (int r = 0; r < R; ++r) {
        for (int j = 0; j < lanes; ++j) put(Y + static_cast<std::int64_t>(r) * p + j, sum[r][j], join);
    }
}

/// One column: its entries are gathered, and each row of the panel is a product of two vectors.
template <int R, int C>
PALPATE_INLINE void multiply_one(const int* column, const double* panel, std::int64_t width, const double* X, int p,
                                 Join join, double* Y) {
    constexpr int gathered = 24;  // a multiple of C and of the lanes
    Lanes sum[R] = {}, a, x;
    double rest[R] = {}, xs[gathered];
    std::int64_t k = 0;
    for (; k + gathered <= width; k += gathered) {
        for (int i = 0; i < gathered; ++i) {
            xs[i] = X[(static_cast<std::int64_t>(C) * column[i / C] + i % C) * p];
        }
        column += gathered / C;
        for (int i = 0; i < gathered; i += lanes) {
            load(xs + i, x);
            for (int r = 0; r < R; ++r) {
                load(panel + r * width + k + i, a);
                sum[r] += a * x;
            }
        }
    }
    for (; k < width; k += C) {
        const double* from = X + static_cast<std::int64_t>(C) * *column++ * p;
        for (int c = 0; c < C; ++c) {
            for (int r = 0; r < R; ++r) rest[r] += panel[r * width + k + c] * from[static_cast<std::int64_t>(c) * p];
        }
    }
    for (int r = 0; r < R; ++r) {
        for (int j = 0; j < lanes; ++j) rest[r] += sum[r][j];
        put(Y + static_cast<std::int64_t>(r) * p, rest[r], join);
    }
}

template <int R, int C>
PALPATE_INLINE void multiply_panels(const Panels& A, int begin, int end, const double* X, int p, Join join, double* Y) {
    for (int i = begin; i < end; ++i) {
        const int* column = A.column + A.start[i];
        const double* panel = A.values + R * C * A.start[i];
        const std::int64_t width = C * (A.start[i + 1] - A.start[i]);
        double* y = Y + static_cast<std::int64_t>(R) * i * p;
        int j = 0;
        for (; j + lanes <= p; j += lanes) multiply_eight<R, C>(column, panel, width, X + j, p, join, y + j);
        for (; j < p; ++j) multiply_one<R, C>(column, panel, width, X + j, p, join, y + j);
    }
}

// A clone is no template.
PALPATE_CLONES void rows_33(const Panels& A, int begin, int end, const double* X, int p, Join join, double* Y) {
    multiply_panels<3, 3>(A, begin, end, X, p, join, Y);
}
PALPATE_CLONES void rows_36(const Panels& A, int begin, int end, const double* X, int p, Join join, double* Y) {
    multiply_panels<3, 6>(A, begin, end, X, p, join, Y);
}
PALPATE_CLONES void rows_63(const Panels& A, int begin, int end, const double* X, int p, Join join, double* Y) {
    multiply_panels<6, 3>(A, begin, end, X, p, join, Y);
}
PALPATE_CLONES void rows_66(const Panels& A, int begin, int end, const double* X, int p, Join join, double* Y) {
    multiply_panels<6, 6>(A, begin, end, X, p, join, Y);
}

}  // namespace

template <>
void multiply_rows<3, 3>(const Panels& A, int begin, int end, const double* X, int p, Join join, double* Y) {
    rows_33(A, begin, end, X, p, join, Y);
}
template <>
void multiply_rows<3, 6>(const Panels& A, int begin, int end, const double* X, int p, Join join, double* Y) {
    rows_36(A, begin, end, X, p, join, Y);
}
template <>
void multiply_rows<6, 3>(const Panels& A, int begin, int end, const double* X, int p, Join join, double* Y) {
    rows_63(A, begin, end, X, p, join, Y);
}
template <>
void multiply_rows<6, 6>(const Panels& A, int begin, int end, const double* X, int p, Join join, double* Y) {
    rows_66(A, begin, end, X, p, join, Y);
}

}  // namespace palpate::fem
