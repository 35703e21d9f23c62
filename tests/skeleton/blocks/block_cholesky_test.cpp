#include "skeleton/blocks/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace palpate::skeleton {
namespace {

using Block = BlockCholesky::Block;
using Vec6 = BlockCholesky::Vec6;

// A random symmetric matrix of 6 x 6 blocks, diagonally strong, in both forms.
struct RandomMatrix {
    Eigen::MatrixXd dense;
    BlockCholesky sparse;

    RandomMatrix(int n, const std::vector<std::array<int, 2>>& couplings, std::uint64_t seed)
        : dense(Eigen::MatrixXd::Zero(6 * n, 6 * n)), sparse(n, couplings) {
        std::mt19937_64 engine(seed);
        std::uniform_real_distribution<double> uniform(-1, 1);
        const auto random_block = [&] { return Block::NullaryExpr([&] { return uniform(engine); }).eval(); };
        for (int i = 0; i < n; ++i) {
            const Block half = random_block();
            const Block A = half * half.transpose() + 30 * Block::Identity();
            dense.block<6, 6>(6 * i, 6 * i) += A;
            sparse.add_diagonal(i, A);
        }
        for (int c = 0; c < static_cast<int>(couplings.size()); ++c) {
            const auto [i, j] = couplings[c];
            const Block A = random_block();
            dense.block<6, 6>(6 * i, 6 * j) += A;
            dense.block<6, 6>(6 * j, 6 * i) += A.transpose();
            sparse.add_coupling(c, A);
        }
    }
};

// Every block with the next, some across, named either way round, one pair twice.
std::vector<std::array<int, 2>> ring_with_chords(int n) {
    std::vector<std::array<int, 2>> couplings{{0, 1}};
    for (int i = 0; i < n; ++i) couplings.push_back({i, (i + 1) % n});
    for (int i = 0; i + 5 < n; i += 3) couplings.push_back({i + 5, i});
    return couplings;
}

TEST(BlockCholesky, SolvesAsADenseMatrixDoes) {
    for (const int n : {3, 7, 30}) {
        RandomMatrix A(n, ring_with_chords(n), 1);
        ASSERT_FALSE(A.sparse.factor(0, Vec6::Ones()));
        // More columns than one strip holds.
        const Eigen::MatrixXd B = Eigen::MatrixXd::Random(6 * n, 19);
        Eigen::MatrixXd X = B;
        A.sparse.solve(X);
        EXPECT_LT((A.dense * X - B).norm(), 1e-13 * B.norm() * n) << n;  // rounding; condition about 10
    }
}

TEST(BlockCholesky, ShiftAddsAMultipleOfTheScale) {
    RandomMatrix A(12, ring_with_chords(12), 2);
    const Vec6 scale = Vec6(1, 2, 3, 4, 5, 6);
    ASSERT_FALSE(A.sparse.factor(7, scale));
    A.dense.diagonal() += 7 * scale.replicate(12, 1);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(72, -1, 1);
    Eigen::MatrixXd x = b;
    A.sparse.solve(x);
    EXPECT_LT((A.dense * x - b).norm(), 1e-13 * b.norm());  // rounding
}

TEST(BlockCholesky, NamesThePivotThatIsNotPositive) {
    RandomMatrix A(9, ring_with_chords(9), 3);
    Block dent = Block::Zero();
    dent(4, 4) = -1000;
    A.sparse.add_diagonal(6, dent);
    const auto pivot = A.sparse.factor(0, Vec6::Ones());
    ASSERT_TRUE(pivot);
    EXPECT_EQ(pivot->block, 6);
    EXPECT_EQ(pivot->entry, 4);
    EXPECT_FALSE(pivot->zero);
    EXPECT_FALSE(A.sparse.factor(1000, Vec6::Ones()));
}

TEST(BlockCholesky, TellsASingularMatrixFromAnIndefiniteOne) {
    // Two blocks with the stiffness [1 -1; -1 1] between them, and nothing that holds them.
    BlockCholesky A(2, {{0, 1}});
    A.add_diagonal(0, Block::Identity());
    A.add_diagonal(1, Block::Identity());
    A.add_coupling(0, -Block::Identity());
    const auto pivot = A.factor(0, Vec6::Ones());
    ASSERT_TRUE(pivot);
    EXPECT_TRUE(pivot->zero);
}

TEST(BlockCholesky, StartsAnewAfterSetZero) {
    RandomMatrix A(9, ring_with_chords(9), 4);
    A.sparse.set_zero();
    for (int i = 0; i < 9; ++i) A.sparse.add_diagonal(i, 4 * Block::Identity());
    ASSERT_FALSE(A.sparse.factor(0, Vec6::Ones()));
    Eigen::MatrixXd x = Eigen::VectorXd::Ones(54);
    A.sparse.solve(x);
    EXPECT_EQ(x, Eigen::VectorXd::Constant(54, 0.25));
}

}  // namespace
}  // namespace palpate::skeleton
