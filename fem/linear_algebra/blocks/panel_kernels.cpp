#include "fem/linear_algebra/blocks/panel_kernels.h"

#include "mesh/system/clones.h"

namespace palpate::fem {

namespace {

constexpr int lanes = 8;
using Lanes = double __attribute__((vector_size(lanes * sizeof(double))));
// In memory they need not be aligned. Clang takes an alignment from a typedef, from an alias it does not.
typedef double LanesInMemory __attribute__((vector_size(lanes * sizeof(double)), aligned(8), may_alias));
typedef float FloatsInMemory __attribute__((vector_size(lanes * sizeof(float)), aligned(4), may_alias));

PALPATE_INLINE void load(const double* from, Lanes& to) { to = *reinterpret_cast<const LanesInMemory*>(from); }
PALPATE_INLINE void load(const float* from, Lanes& to) {
    to = __builtin_convertvector(*reinterpret_cast<const FloatsInMemory*>(from), Lanes);
}

PALPATE_INLINE void put(double* y, double sum, Join join) {
    *y = join == Join::set ? sum : join == Join::add ? *y + sum : *y - sum;
}

/// Asks for the values that rows to come need: a row's panel is R short streams, which end before the processor has
/// made them out. A page ahead is a choice (tests/bench/fem/RESULTS.md); asking beyond the end does nothing.
template <std::size_t bytes>
PALPATE_INLINE void ahead(const void* now) {
    constexpr std::size_t line = 64, page = 4096;
    for (std::size_t k = 0; k < bytes + line - 1; k += line)
        __builtin_prefetch(static_cast<const char*>(now) + page + k);
}

/// Eight columns of X at once: each entry of A meets a vector.
template <int R, int C, class Value>
PALPATE_INLINE void multiply_eight(const int* column, const Value* panel, std::int64_t width, const double* X, int p,
                                   Join join, double* Y) {
    Lanes sum[R] = {}, x;
    for (std::int64_t k = 0; k < width; k += C) {
        const double* from = X + static_cast<std::int64_t>(C) * *column++ * p;
        ahead<R * C * sizeof(Value)>(panel + R * k);
        for (int c = 0; c < C; ++c) {
            load(from + static_cast<std::int64_t>(c) * p, x);
            for (int r = 0; r < R; ++r) sum[r] += static_cast<double>(panel[r * width + k + c]) * x;
        }
    }
    for (int r = 0; r < R; ++r) {
        for (int j = 0; j < lanes; ++j) put(Y + static_cast<std::int64_t>(r) * p + j, sum[r][j], join);
    }
}

/// One column: its entries are gathered, and each row of the panel is a product of two vectors.
template <int R, int C, class Value>
PALPATE_INLINE void multiply_one(const int* column, const Value* panel, std::int64_t width, const double* X, int p,
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
        ahead<R * gathered * sizeof(Value)>(panel + R * k);
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
        ahead<R * C * sizeof(Value)>(panel + R * k);
        for (int c = 0; c < C; ++c) {
            for (int r = 0; r < R; ++r) rest[r] += panel[r * width + k + c] * from[static_cast<std::int64_t>(c) * p];
        }
    }
    for (int r = 0; r < R; ++r) {
        for (int j = 0; j < lanes; ++j) rest[r] += sum[r][j];
        put(Y + static_cast<std::int64_t>(r) * p, rest[r], join);
    }
}

template <int R, int C, class Value>
PALPATE_INLINE void multiply_panels(const Panels<Value>& A, int begin, int end, const double* X, int p, Join join,
                                    double* Y) {
    for (int i = begin; i < end; ++i) {
        const int* column = A.column + A.start[i];
        const Value* panel = A.values + R * C * A.start[i];
        const std::int64_t width = C * (A.start[i + 1] - A.start[i]);
        double* y = Y + static_cast<std::int64_t>(R) * i * p;
        int j = 0;
        for (; j + lanes <= p; j += lanes) multiply_eight<R, C>(column, panel, width, X + j, p, join, y + j);
        for (; j < p; ++j) multiply_one<R, C>(column, panel, width, X + j, p, join, y + j);
    }
}

}  // namespace

// A clone is no template.
#define PALPATE_PRODUCT(R, C, Value)                                                                              \
    PALPATE_CLONES void rows_##R##C##_##Value(const Panels<Value>& A, int begin, int end, const double* X, int p, \
                                              Join join, double* Y) {                                             \
        multiply_panels<R, C>(A, begin, end, X, p, join, Y);                                                      \
    }                                                                                                             \
    template <>                                                                                                   \
    void multiply_rows<R, C>(const Panels<Value>& A, int begin, int end, const double* X, int p, Join join,       \
                             double* Y) {                                                                         \
        rows_##R##C##_##Value(A, begin, end, X, p, join, Y);                                                      \
    }
PALPATE_PRODUCT(3, 3, double)
PALPATE_PRODUCT(3, 6, double)
PALPATE_PRODUCT(6, 6, double)
PALPATE_PRODUCT(3, 3, float)
PALPATE_PRODUCT(3, 6, float)
PALPATE_PRODUCT(6, 3, float)
PALPATE_PRODUCT(6, 6, float)
#undef PALPATE_PRODUCT

}  // namespace palpate::fem
