#pragma once

#include <memory>

#include "skeleton/blocks/block_cholesky.h"

namespace palpate::skeleton {

/// A symmetric matrix of 6 x 6 blocks that is factored again and again, in the way that its size asks for. Members are
/// as those of BlockCholesky.
class TangentMatrix {
public:
    using Block = BlockCholesky::Block;
    using Vec6 = BlockCholesky::Vec6;

    TangentMatrix() = default;
    virtual ~TangentMatrix() = default;
    TangentMatrix(const TangentMatrix&) = delete;
    TangentMatrix& operator=(const TangentMatrix&) = delete;

    virtual void set_zero() = 0;
    virtual void add_diagonal(int i, const Block& A) = 0;
    virtual void add_coupling(int c, const Block& A) = 0;
    virtual std::optional<BlockCholesky::BadPivot> factor(double shift, const Vec6& scale) = 0;
    virtual void solve(Eigen::MatrixXd& B) const = 0;
};

/// By supernodes where blocks are many, else block by block.
std::unique_ptr<TangentMatrix> make_tangent_matrix(int n, const std::vector<std::array<int, 2>>& couplings);

std::unique_ptr<TangentMatrix> make_matrix_of_few_blocks(int n, const std::vector<std::array<int, 2>>& couplings);
/// @throws SolverFailure when memory does not suffice.
std::unique_ptr<TangentMatrix> make_matrix_of_many_blocks(int n, const std::vector<std::array<int, 2>>& couplings);

}  // namespace palpate::skeleton
