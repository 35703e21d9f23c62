#include "skeleton/statics/matrices/tangent_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

namespace palpate::skeleton {
namespace {

using Block = TangentMatrix::Block;
using Vec6 = TangentMatrix::Vec6;
using Couplings = std::vector<std::array<int, 2>>;

/// Every block with the next and some across, named either way round, some pairs twice.
Couplings ring_with_chords(int n) {
    Couplings couplings{{0, 1}, {1, 0}};
    for (int i = 0; i < n; ++i) couplings.push_back({i, (i + 1) % n});
    for (int i = 0; i + 5 < n; i += 3) couplings.push_back({i + 5, i});
    return couplings;
}

class TangentMatrices : public ::testing::TestWithParam<decltype(&make_matrix_of_few_blocks)> {
protected:
    static constexpr int n = 40;
    Couplings couplings = ring_with_chords(n);
    std::unique_ptr<TangentMatrix> matrix = GetParam()(n, couplings);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(6 * n, 6 * n);

    /// A symmetric matrix with `strength` on its diagonal.
    void fill(double strength) {
        std::srand(1);
        matrix->set_zero();
        dense.setZero();
        for (int i = 0; i < n; ++i) {
            const Block half = Block::Random(), A = half * half.transpose() + strength * Block::Identity();
            dense.block<6, 6>(6 * i, 6 * i) += A;
            matrix->add_diagonal(i, A);
        }
        for (int c = 0; c < std::ssize(couplings); ++c) {
            const auto [i, j] = couplings[c];
            const Block A = Block::Random();
            dense.block<6, 6>(6 * i, 6 * j) += A;
            dense.block<6, 6>(6 * j, 6 * i) += A.transpose();
            matrix->add_coupling(c, A);
        }
    }

    /// Largest error of a solution, by the matrix that should have been factored.
    double error(const Eigen::MatrixXd& of) const {
        const Eigen::MatrixXd B = Eigen::MatrixXd::Random(6 * n, 5);
        Eigen::MatrixXd X = B;
        matrix->solve(X);
        return (of * X - B).cwiseAbs().maxCoeff();
    }
};

TEST_P(TangentMatrices, SolveAsADenseMatrixDoes) {
    for (const double strength : {30.0, 50.0}) {  // the structure serves again
        fill(strength);
        ASSERT_FALSE(matrix->factor(0, Vec6::Ones()));
        EXPECT_LT(error(dense), 1e-12) << strength;  // rounding, condition of some 10
    }
}

TEST_P(TangentMatrices, AShiftAddsAMultipleOfTheScale) {
    fill(30);
    const Vec6 scale = Vec6::LinSpaced(1, 6);
    ASSERT_FALSE(matrix->factor(3, scale));
    const Eigen::VectorXd more = 3 * scale.replicate(n, 1);
    EXPECT_LT(error(dense + Eigen::MatrixXd(more.asDiagonal())), 1e-12);
    ASSERT_FALSE(matrix->factor(0, scale));  // and the next one is without
    EXPECT_LT(error(dense), 1e-12);
}

TEST_P(TangentMatrices, TellWhatIsNotPositive) {
    fill(30);
    Block A = Block::Zero();
    A(4, 4) = -1000;
    matrix->add_diagonal(7, A);
    dense(7 * 6 + 4, 7 * 6 + 4) -= 1000;
    const auto pivot = matrix->factor(0, Vec6::Ones());
    ASSERT_TRUE(pivot);
    EXPECT_EQ(pivot->block, 7);
    EXPECT_EQ(pivot->entry, 4);
    EXPECT_FALSE(pivot->zero);
    ASSERT_FALSE(matrix->factor(1000, Vec6::Ones()));
    EXPECT_LT(error(dense + 1000 * Eigen::MatrixXd::Identity(6 * n, 6 * n)), 1e-12);
}

// Supernodes take pivots below 1e-14 of the largest for rounding, blocks those below 1e-13 of what stood there.
TEST_P(TangentMatrices, OfScalesFarApartAreSolvedToo) {
    matrix->set_zero();
    for (int i = 0; i < n; ++i) matrix->add_diagonal(i, (i == 3 ? 1e-9 : 1e9) * Block::Identity());
    ASSERT_FALSE(matrix->factor(0, Vec6::Ones()));
    Eigen::MatrixXd X = Eigen::MatrixXd::Ones(6 * n, 1);
    matrix->solve(X);
    EXPECT_DOUBLE_EQ(X(18, 0), 1e9);
    EXPECT_DOUBLE_EQ(X(0, 0), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(, TangentMatrices, ::testing::Values(&make_matrix_of_few_blocks, &make_matrix_of_many_blocks),
                         [](const auto& tested) {
                             return tested.param == &make_matrix_of_few_blocks ? "Few" : "Many";
                         });

}  // namespace
}  // namespace palpate::skeleton
