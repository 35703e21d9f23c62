#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "skeleton/blocks/block_kernels.h"

namespace palpate::skeleton {

/// Sparse Cholesky factorisation of a symmetric matrix of 6 x 6 blocks: a block a rigid node, a coupling a link.
///
/// Ordering (minimum degree on the graph of the blocks) and symbolic factorisation are made once; values, shift and
/// factor may change again and again.
class BlockCholesky {
public:
    using Block = Eigen::Matrix<double, 6, 6>;
    using Vec6 = Eigen::Matrix<double, 6, 1>;

    /// The matrix has n x n blocks, of which the diagonal and the couplings (i, j), i != j, may be other than zero; a
    /// pair may be named several times.
    BlockCholesky(int n, const std::vector<std::array<int, 2>>& couplings);

    void set_zero();
    void add_diagonal(int i, const Block& A) { matrix_[slot_of_diagonal_[i]] += A; }
    /// Adds A at block (i, j) of coupling c, and its transpose at (j, i).
    void add_coupling(int c, const Block& A);

    /// A scalar pivot that is not positive.
    struct BadPivot {
        int block, entry;  // of the matrix, entry in 0..5
        bool zero;         // not negative but lost in rounding: the matrix is singular
    };
    /// Factors matrix + shift diag(scale, scale, ...). Nothing when it is positive definite. Allocates nothing.
    std::optional<BadPivot> factor(double shift, const Vec6& scale);

    /// Multiplications that a factorisation takes, as a multiple of those of a solution for one column.
    double cost_in_solutions() const;

    /// Solves in place for the columns of B (6n x p). @pre the last `factor` succeeded.
    void solve(Eigen::MatrixXd& B) const;
    /// The same for one column b (6n), without allocating.
    void solve(double* b);

private:
    struct Column {
        std::vector<int> rows;  // of the blocks below the diagonal, ascending
        int first;              // place of the diagonal block among the blocks; those of `rows` follow
    };

    void factor_symbolically(const std::vector<std::array<int, 2>>& couplings);
    int slot(int row, int column) const;
    /// `work`: eight numbers where b has six.
    void solve(double* b, Eigen::Index columns, double* work) const;

    int n_;
    std::vector<int> position_;               // in the elimination order, of each block
    std::vector<int> block_at_;               // its inverse
    std::vector<Column> columns_;             // in the elimination order
    std::vector<std::vector<int>> touching_;  // columns k < j with a block at row j, of each j
    std::vector<int> slot_of_diagonal_;
    std::vector<int> slot_of_coupling_;
    std::vector<char> transposed_;     // couplings that lie above the diagonal in the elimination order
    std::vector<Block> matrix_;        // as the columns tell (fill-in included)
    std::vector<PaddedBlock> factor_;  // the same
    std::vector<PaddedBlock*> place_;  // work: of each row's block in the column at hand
    std::vector<double> right_hand_;   // work: of solve (8n)
};

}  // namespace palpate::skeleton
