#include "fem/linear_algebra/blocks/block_matrix.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <numeric>

namespace palpate::fem {

namespace {

constexpr int grain = 256;  // rows that a thread takes at once

/// Calls work(begin, end) on ranges of rows.
template <class Work>
void for_rows(int rows, Work&& work) {
    tbb::parallel_for(tbb::blocked_range<int>(0, rows, grain), [&](const auto& range) {  //
        work(range.begin(), range.end());
    });
}

}  // namespace

template <int R, int C, class Value>
void multiply(const BlockMatrix<R, C, Value>& A, const MultiVector& X, MultiVector& Y, Join join) {
    assert(X.rows() == Eigen::Index{C} * A.columns && Y.rows() == Eigen::Index{R} * A.rows() && X.cols() == Y.cols());
    const Panels<Value> panels{A.start.data(), A.column.data(), A.values.data()};
    for_rows(A.rows(), [&](int begin, int end) {
        multiply_rows<R, C, Value>(panels, begin, end, X.data(), static_cast<int>(X.cols()), join, Y.data());
    });
}

template <int R, int K, int C>
BlockMatrix<R, C> product(const BlockMatrix<R, K>& A, const BlockMatrix<K, C>& B) {
    // For each column of the row at hand, first whether the row reaches it, then where its block lies.
    tbb::enumerable_thread_specific<std::vector<int>> places([&] { return std::vector<int>(B.columns, -1); });

    std::vector<std::vector<int>> pattern(A.rows());
    for_rows(A.rows(), [&](int begin, int end) {
        std::vector<int>& seen = places.local();
        for (int i = begin; i < end; ++i) {
            for (const int k : A.columns_of(i)) {
                for (const int j : B.columns_of(k)) {
                    if (seen[j] == i) continue;
                    seen[j] = i;
                    pattern[i].push_back(j);
                }
            }
            std::ranges::sort(pattern[i]);
        }
    });

    // Rows are sums of multiples of B's rows.
    auto result = with_pattern<R, C>(pattern, B.columns);
    for_rows(A.rows(), [&](int begin, int end) {
        std::vector<int>& place = places.local();
        for (int i = begin; i < end; ++i) {
            for (int k = 0; k < result.count(i); ++k) place[result.columns_of(i)[k]] = k;
            auto panel = result.panel(i);
            for (int a = 0; a < A.count(i); ++a) {
                const int k = A.columns_of(i)[a];
                for (int b = 0; b < B.count(k); ++b) {
                    const Eigen::Index at = Eigen::Index{C} * place[B.columns_of(k)[b]];
                    panel.template middleCols<C>(at) += A.block(i, a).lazyProduct(B.block(k, b));
                }
            }
        }
    });
    return result;
}

template <int R, int C>
BlockMatrix<C, R> transpose(const BlockMatrix<R, C>& A) {
    BlockMatrix<C, R> result;
    result.columns = A.rows();
    result.start.assign(A.columns + 1, 0);
    for (const int j : A.column) ++result.start[j + 1];
    std::partial_sum(result.start.begin(), result.start.end(), result.start.begin());
    result.column.resize(A.blocks());
    result.values.resize(A.values.size());
    std::vector<int> filled(A.columns, 0);
    for (int i = 0; i < A.rows(); ++i) {
        for (int k = 0; k < A.count(i); ++k) {
            const int j = A.columns_of(i)[k], at = filled[j]++;
            result.column[result.start[j] + at] = i;
            result.block(j, at) = A.block(i, k).transpose();
        }
    }
    return result;
}

// On the finest level a node has three unknowns, on all others six.
template void multiply(const BlockMatrix<3, 3>&, const MultiVector&, MultiVector&, Join);
template void multiply(const BlockMatrix<3, 6>&, const MultiVector&, MultiVector&, Join);
template void multiply(const BlockMatrix<6, 6>&, const MultiVector&, MultiVector&, Join);
template void multiply(const BlockMatrix<3, 3, float>&, const MultiVector&, MultiVector&, Join);
template void multiply(const BlockMatrix<3, 6, float>&, const MultiVector&, MultiVector&, Join);
template void multiply(const BlockMatrix<6, 3, float>&, const MultiVector&, MultiVector&, Join);
template void multiply(const BlockMatrix<6, 6, float>&, const MultiVector&, MultiVector&, Join);
template BlockMatrix<3, 6> product(const BlockMatrix<3, 3>&, const BlockMatrix<3, 6>&);
template BlockMatrix<6, 6> product(const BlockMatrix<6, 3>&, const BlockMatrix<3, 6>&);
template BlockMatrix<6, 6> product(const BlockMatrix<6, 6>&, const BlockMatrix<6, 6>&);
template BlockMatrix<6, 3> transpose(const BlockMatrix<3, 6>&);
template BlockMatrix<6, 6> transpose(const BlockMatrix<6, 6>&);

BlockMatrix<3, 3> symmetric_blocks(const LowerMatrix& K) {
    using Column = LowerMatrix::InnerIterator;
    const auto nodes = static_cast<int>(K.cols() / 3);
    std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(nodes));
    for (int column = 0; column < nodes; ++column) {
        for (Column entry(K, Eigen::Index{3} * column); entry; ++entry) {
            if (entry.row() % 3 != 0) continue;
            const auto row = static_cast<int>(entry.row() / 3);
            neighbours[column].push_back(row);
            if (row != column) neighbours[row].push_back(column);
        }
    }
    BlockMatrix<3, 3> A = with_pattern<3, 3>(neighbours, nodes);
    std::vector<int> filled(static_cast<std::size_t>(nodes), 0);  // blocks of each row
    for (int column = 0; column < nodes; ++column) {
        Column first(K, Eigen::Index{3} * column), second(K, Eigen::Index{3} * column + 1),
            third(K, Eigen::Index{3} * column + 2);
        while (first) {
            const auto row = static_cast<int>(first.row() / 3);
            Eigen::Matrix3d block;
            for (int r = 0; r < 3; ++r, ++first, ++second, ++third)
                block.row(r) << first.value(), second.value(), third.value();
            A.block(column, filled[column]++) = block.transpose();
            if (row != column) A.block(row, filled[row]++) = block;
        }
    }
    return A;
}

}  // namespace palpate::fem
