#pragma once

#include <cstdint>

namespace palpate::fem {

/// How a product is joined with what stands in Y.
enum class Join { set, add, subtract };

/// A BlockMatrix, bare.
template <class Value>
struct Panels {
    const std::int64_t* start;
    const int* column;
    const Value* values;
};

/// Rows [begin, end) of Y = A X, Y + A X or Y - A X, where A has blocks of R x C and X and Y have p columns, by rows.
/// Sums are doubles.
template <int R, int C, class Value>
void multiply_rows(const Panels<Value>& A, int begin, int end, const double* X, int p, Join join, double* Y);

}  // namespace palpate::fem
