#include <algorithm>

#include "skeleton/statics/matrices/block_structure.h"
#include "skeleton/statics/matrices/tangent_matrix.h"

namespace palpate::skeleton {
namespace {

constexpr int many = 1000;  // 500 take as long either way

/// Factors by supernodes. What these do not find positive definite is left to blocks: they say where it is not, or
/// solve after all.
class ManyBlocks : public TangentMatrix {
public:
    ManyBlocks(int n, const std::vector<std::array<int, 2>>& couplings)
        : n_(n),
          couplings_(couplings),
          structure_(n, couplings),
          K_(structure_.zero()),
          factor_(structure_.supernodes()) {}

    void set_zero() override { std::fill_n(K_.valuePtr(), K_.nonZeros(), 0.0); }
    void add_diagonal(int i, const Block& A) override { structure_.add(i, i, A, K_); }
    void add_coupling(int c, const Block& A) override { structure_.add(couplings_[c][0], couplings_[c][1], A, K_); }

    std::optional<BlockCholesky::BadPivot> factor(double shift, const Vec6& scale) override {
        blocks_.reset();
        if (factor_shifted(shift, scale)) return std::nullopt;
        const std::vector<std::array<int, 2>> pairs = structure_.pairs();
        blocks_ = std::make_unique<BlockCholesky>(n_, pairs);
        for (int i = 0; i < n_; ++i) blocks_->add_diagonal(i, structure_.block(i, i, K_));
        for (int c = 0; c < std::ssize(pairs); ++c) {
            blocks_->add_coupling(c, structure_.block(pairs[c][0], pairs[c][1], K_));
        }
        return blocks_->factor(shift, scale);
    }

    void solve(Eigen::MatrixXd& B) const override {
        if (blocks_) return blocks_->solve(B);
        fem::MultiVector ordered(B.rows(), B.cols());
        for (int i = 0; i < n_; ++i) ordered.middleRows<6>(from(i)) = B.middleRows<6>(Eigen::Index{6} * i);
        factor_.solve(ordered);
        for (int i = 0; i < n_; ++i) B.middleRows<6>(Eigen::Index{6} * i) = ordered.middleRows<6>(from(i));
    }

private:
    Eigen::Index from(int i) const { return Eigen::Index{6} * structure_.position(i); }

    bool factor_shifted(double shift, const Vec6& scale) {
        if (shift == 0) return factor_.factor(K_);
        fem::LowerMatrix K = K_;
        for (int i = 0; i < n_; ++i) structure_.add(i, i, (shift * scale).asDiagonal().toDenseMatrix(), K);
        return factor_.factor(K);
    }

    int n_;
    std::vector<std::array<int, 2>> couplings_;
    BlockStructure structure_;
    fem::LowerMatrix K_;
    fem::Cholesky factor_;
    std::unique_ptr<BlockCholesky> blocks_;
};

}  // namespace

std::unique_ptr<TangentMatrix> make_matrix_of_many_blocks(int n, const std::vector<std::array<int, 2>>& couplings) {
    return std::make_unique<ManyBlocks>(n, couplings);
}

std::unique_ptr<TangentMatrix> make_tangent_matrix(int n, const std::vector<std::array<int, 2>>& couplings) {
    return n < many ? make_matrix_of_few_blocks(n, couplings) : make_matrix_of_many_blocks(n, couplings);
}

}  // namespace palpate::skeleton
