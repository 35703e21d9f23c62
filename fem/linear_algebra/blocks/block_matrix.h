#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fem/linear_algebra/blocks/panel_kernels.h"
#include "fem/linear_algebra/cholesky/cholesky.h"

namespace palpate::fem {

/// A sparse matrix of small dense blocks (R x C), row by row. The blocks of a row lie beside each other as one dense
/// panel of R rows, so that each of these is contiguous in memory. Values in single precision, which products with
/// large matrices pass through memory in half the time, are for what need not be exact.
template <int R, int C, class Value = double>
struct BlockMatrix {
    int columns = 0;                     // of blocks
    std::vector<std::int64_t> start{0};  // of each row's blocks (rows + 1)
    std::vector<int> column;             // of each block, ascending in a row
    std::vector<Value> values;           // R * C for each block

    using Panel = Eigen::Map<const Eigen::Matrix<Value, R, Eigen::Dynamic, Eigen::RowMajor>>;
    using MutablePanel = Eigen::Map<Eigen::Matrix<Value, R, Eigen::Dynamic, Eigen::RowMajor>>;

    int rows() const { return static_cast<int>(start.size()) - 1; }
    std::int64_t blocks() const { return start.back(); }
    int count(int row) const { return static_cast<int>(start[row + 1] - start[row]); }
    std::span<const int> columns_of(int row) const { return std::span(column).subspan(start[row], count(row)); }
    Panel panel(int row) const { return Panel(&values[R * C * start[row]], R, Eigen::Index{C} * count(row)); }
    MutablePanel panel(int row) { return MutablePanel(&values[R * C * start[row]], R, Eigen::Index{C} * count(row)); }
    auto block(int row, int k) const { return panel(row).template middleCols<C>(Eigen::Index{C} * k); }
    auto block(int row, int k) { return panel(row).template middleCols<C>(Eigen::Index{C} * k); }
};

/// Room for rows with blocks in these columns, ascending; all values zero.
template <int R, int C>
BlockMatrix<R, C> with_pattern(const std::vector<std::vector<int>>& rows, int columns) {
    BlockMatrix<R, C> result;
    result.columns = columns;
    for (const auto& row : rows) result.start.push_back(result.blocks() + static_cast<std::int64_t>(row.size()));
    result.column.reserve(result.blocks());
    for (const auto& row : rows) result.column.insert(result.column.end(), row.begin(), row.end());
    result.values.assign(R * C * result.blocks(), 0.0);
    return result;
}

/// Y = A X, Y + A X or Y - A X; X (C columns x p), Y (R rows x p). Entries of A are read once for all p. In parallel
/// over rows: the same numbers on any number of threads, as everything here.
template <int R, int C, class Value>
void multiply(const BlockMatrix<R, C, Value>& A, const MultiVector& X, MultiVector& Y, Join join = Join::set);

/// A B.
template <int R, int K, int C>
BlockMatrix<R, C> product(const BlockMatrix<R, K>& A, const BlockMatrix<K, C>& B);

template <int R, int C>
BlockMatrix<C, R> transpose(const BlockMatrix<R, C>& A);

/// All blocks of a symmetric matrix whose lower half is given, with whole blocks.
BlockMatrix<3, 3> symmetric_blocks(const LowerMatrix& K);

/// The same in single precision.
template <int R, int C>
BlockMatrix<R, C, float> rounded(const BlockMatrix<R, C>& A) {
    return {A.columns, A.start, A.column, std::vector<float>(A.values.begin(), A.values.end())};
}

}  // namespace palpate::fem
