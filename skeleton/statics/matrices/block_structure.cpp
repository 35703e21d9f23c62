#include "skeleton/statics/matrices/block_structure.h"

#include <algorithm>

namespace palpate::skeleton {
namespace {

/// For each node its neighbours with a number not below its own, ascending.
std::vector<std::vector<int>> lower_neighbours(const std::vector<std::array<int, 2>>& pairs,
                                               const std::vector<int>& number) {
    std::vector<std::vector<int>> lower(number.size());
    for (std::size_t i = 0; i < lower.size(); ++i) lower[i].push_back(static_cast<int>(i));
    for (const auto& [a, b] : pairs) {
        if (std::min(a, b) < 0) continue;
        const auto [low, high] = std::minmax(number[a], number[b]);
        lower[low].push_back(high);
    }
    for (std::vector<int>& rows : lower) {
        std::ranges::sort(rows);
        const auto rest = std::unique(rows.begin(), rows.end());
        rows.erase(rest, rows.end());
    }
    return lower;
}

}  // namespace

BlockStructure::BlockStructure(int n, const std::vector<std::array<int, 2>>& pairs) {
    std::vector<int> as_they_come(n);
    for (int i = 0; i < n; ++i) as_they_come[i] = i;
    fem::Elimination elimination = fem::analyse(lower_neighbours(pairs, as_they_come), 6);
    position_ = std::move(elimination.position);
    supernodes_ = std::make_shared<const fem::Supernodes>(std::move(elimination.supernodes));
    columns_ = lower_neighbours(pairs, position_);
}

std::vector<std::array<int, 2>> BlockStructure::pairs() const {
    std::vector<int> block_at(position_.size());
    for (int i = 0; i < std::ssize(position_); ++i) block_at[position_[i]] = i;
    std::vector<std::array<int, 2>> pairs;
    for (std::size_t column = 0; column < columns_.size(); ++column) {
        for (std::size_t k = 1; k < columns_[column].size(); ++k) {
            pairs.push_back({block_at[column], block_at[columns_[column][k]]});
        }
    }
    return pairs;
}

fem::LowerMatrix BlockStructure::zero() const {
    const auto size = static_cast<Eigen::Index>(6 * columns_.size());
    fem::LowerMatrix K(size, size);
    std::int64_t* start = K.outerIndexPtr();
    start[0] = 0;
    for (Eigen::Index c = 0; c < size; ++c)
        start[c + 1] = start[c] + static_cast<std::int64_t>(6 * columns_[c / 6].size());
    K.resizeNonZeros(start[size]);
    std::fill_n(K.valuePtr(), start[size], 0.0);
    std::int64_t* row = K.innerIndexPtr();
    for (Eigen::Index c = 0; c < size; ++c) {
        for (const int node : columns_[c / 6]) {
            for (int i = 0; i < 6; ++i) *row++ = std::int64_t{6} * node + i;
        }
    }
    return K;
}

/// Of a block's first row in each of its columns.
Eigen::Index BlockStructure::place(int row, int column) const {
    const std::vector<int>& rows = columns_[column];
    return 6 * (std::ranges::lower_bound(rows, row) - rows.begin());
}

void BlockStructure::add(int i, int j, const Block& A, fem::LowerMatrix& K) const {
    const int p = position_[i], q = position_[j], column = std::min(p, q);
    const Eigen::Index at = place(std::max(p, q), column);
    for (int c = 0; c < 6; ++c) {
        double* own = K.valuePtr() + K.outerIndexPtr()[6 * column + c] + at;
        for (int r = 0; r < 6; ++r) own[r] += p < q ? A(c, r) : A(r, c);
    }
}

BlockStructure::Block BlockStructure::block(int i, int j, const fem::LowerMatrix& K) const {
    const int p = position_[i], q = position_[j], column = std::min(p, q);
    const Eigen::Index at = place(std::max(p, q), column);
    Block A;
    for (int c = 0; c < 6; ++c) {
        const double* own = K.valuePtr() + K.outerIndexPtr()[6 * column + c] + at;
        for (int r = 0; r < 6; ++r) (p < q ? A(c, r) : A(r, c)) = own[r];
    }
    return A;
}

}  // namespace palpate::skeleton
