#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "fem/linear_algebra/cholesky/cholesky.h"

namespace palpate::fem {

using Row = Eigen::Array<double, 1, Eigen::Dynamic>;

inline constexpr Eigen::Index vector_grain = 4096;  // rows of a Block that a thread takes at once

/// Calls work(first row, rows) on parts of `rows` rows, the same on any number of threads.
template <class Work>
void for_parts(Eigen::Index rows, Work&& work) {
    tbb::parallel_for(Eigen::Index(0), (rows + vector_grain - 1) / vector_grain, [&](Eigen::Index part) {
        const Eigen::Index first = part * vector_grain;
        work(first, std::min(vector_grain, rows - first));
    });
}

/// The products of each column of x with that of y, always summed in the same order.
inline Row dots(const MultiVector& x, const MultiVector& y) {
    const Eigen::Index parts = (x.rows() + vector_grain - 1) / vector_grain;
    Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> sums(parts, x.cols());
    for_parts(x.rows(), [&](Eigen::Index first, Eigen::Index rows) {
        sums.row(first / vector_grain) =
            (x.middleRows(first, rows).array() * y.middleRows(first, rows).array()).colwise().sum();
    });
    return sums.colwise().sum();
}

/// y += x diag(a)
inline void add_scaled(const MultiVector& x, const Row& a, MultiVector& y) {
    for_parts(x.rows(), [&](Eigen::Index first, Eigen::Index rows) {
        y.middleRows(first, rows).array() += x.middleRows(first, rows).array().rowwise() * a;
    });
}

/// y <- x + y diag(a)
inline void scale_and_add(const MultiVector& x, const Row& a, MultiVector& y) {
    for_parts(x.rows(), [&](Eigen::Index first, Eigen::Index rows) {
        y.middleRows(first, rows) = x.middleRows(first, rows).array() + y.middleRows(first, rows).array().rowwise() * a;
    });
}

}  // namespace palpate::fem
