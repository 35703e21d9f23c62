#include "skeleton/statics/matrices/tangent_matrix.h"

namespace palpate::skeleton {
namespace {

class FewBlocks : public TangentMatrix {
public:
    FewBlocks(int n, const std::vector<std::array<int, 2>>& couplings) : matrix_(n, couplings) {}
    void set_zero() override { matrix_.set_zero(); }
    void add_diagonal(int i, const Block& A) override { matrix_.add_diagonal(i, A); }
    void add_coupling(int c, const Block& A) override { matrix_.add_coupling(c, A); }
    std::optional<BlockCholesky::BadPivot> factor(double shift, const Vec6& scale) override {
        return matrix_.factor(shift, scale);
    }
    void solve(Eigen::MatrixXd& B) const override { matrix_.solve(B); }

private:
    BlockCholesky matrix_;
};

}  // namespace

std::unique_ptr<TangentMatrix> make_matrix_of_few_blocks(int n, const std::vector<std::array<int, 2>>& couplings) {
    return std::make_unique<FewBlocks>(n, couplings);
}

}  // namespace palpate::skeleton
