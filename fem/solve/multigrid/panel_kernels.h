#pragma once

#include <cstdint>

namespace palpate::fem {

/// How a product is joined with what stands in Y.
enum class Join { set, add, subtract };

/// A BlockMatrix, bare.
struct Panels {
    const std::int64_t* start;
    const int* column;
    const double* values;
};

/// Rows [begin, end) of Y = A X, Y + A X or Y - A X, where A has blocks of R x C and X and Y have p columns, by rows.
template <int R, int C>
void multiply_rows(const Panels& A, int begin, int end, const double* X, int p, Join join, double* Y);

}  // namespace palpate::fem
