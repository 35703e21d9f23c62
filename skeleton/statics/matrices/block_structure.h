#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "fem/linear_algebra/cholesky/cholesky.h"

namespace palpate::skeleton {

/// Where the blocks of a symmetric matrix of 6 x 6 blocks lie, to be factored by supernodes [fem::Cholesky].
class BlockStructure {
public:
    using Block = Eigen::Matrix<double, 6, 6>;

    /// Of n x n blocks, of which the diagonal and those of the pairs (i, j) may be other than zero. Pairs may be named
    /// several times; those with an index below 0 or twice the same are passed over.
    BlockStructure(int n, const std::vector<std::array<int, 2>>& pairs);

    const std::shared_ptr<const fem::Supernodes>& supernodes() const { return supernodes_; }
    int position(int i) const { return position_[i]; }  // of a block in the order of elimination
    std::vector<std::array<int, 2>> pairs() const;      // each once

    /// The matrix itself, in that order, all zero.
    fem::LowerMatrix zero() const;
    /// Adds a block at (i, j), and its transpose at (j, i), to values of such a matrix.
    void add(int i, int j, const Block& A, fem::LowerMatrix& K) const;
    /// The block at (i, j); that on the diagonal as a whole.
    Block block(int i, int j, const fem::LowerMatrix& K) const;

private:
    Eigen::Index place(int row, int column) const;

    std::vector<int> position_;
    std::vector<std::vector<int>> columns_;  // rows of each column of blocks in order, its own first, ascending
    std::shared_ptr<const fem::Supernodes> supernodes_;
};

}  // namespace palpate::skeleton
