#include "fem/linear_algebra/multigrid/coarsest_level.h"

#include "fem/linear_algebra/cholesky/supernodes.h"

namespace palpate::fem {

namespace {

/// The lower half in the order of elimination. Unknowns that nothing holds get a stiffness of their own.
LowerMatrix lower_half(const BlockMatrix<6, 6>& A, const std::vector<int>& position) {
    std::vector<Eigen::Triplet<double, std::int64_t>> entries;
    for (int i = 0; i < A.rows(); ++i) {
        for (int k = 0; k < A.count(i); ++k) {
            const std::int64_t row = position[i], column = position[A.columns_of(i)[k]];
            const auto block = A.block(i, k);
            for (int r = 0; row >= column && r < 6; ++r) {
                for (int c = 0; c < 6; ++c) {
                    const bool nothing = row == column && r == c && block(r, c) == 0;
                    entries.emplace_back(6 * row + r, 6 * column + c,
                                         nothing ? block.diagonal().maxCoeff() : block(r, c));
                }
            }
        }
    }
    const Eigen::Index size = Eigen::Index{6} * A.rows();
    LowerMatrix K(size, size);
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
}

}  // namespace

CoarseSolver::CoarseSolver(const BlockMatrix<6, 6>& A) {
    std::vector<std::vector<int>> lower(A.rows());
    for (int i = 0; i < A.rows(); ++i) {
        for (const int j : A.columns_of(i)) {
            if (j >= i) lower[i].push_back(j);
        }
    }
    Elimination elimination = analyse(lower, 6);
    position_ = std::move(elimination.position);
    factor_ = std::make_unique<Cholesky>(std::make_shared<const Supernodes>(std::move(elimination.supernodes)),
                                         lower_half(A, position_));
}

void CoarseSolver::solve(const MultiVector& f, MultiVector& x) const {
    MultiVector ordered(f.rows(), f.cols());
    for (std::size_t i = 0; i < position_.size(); ++i) {
        ordered.middleRows<6>(Eigen::Index{6} * position_[i]) = f.middleRows<6>(static_cast<Eigen::Index>(6 * i));
    }
    factor_->solve(ordered);
    for (std::size_t i = 0; i < position_.size(); ++i) {
        x.middleRows<6>(static_cast<Eigen::Index>(6 * i)) = ordered.middleRows<6>(Eigen::Index{6} * position_[i]);
    }
}

}  // namespace palpate::fem
