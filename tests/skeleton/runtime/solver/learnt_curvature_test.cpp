#include "skeleton/runtime/solver/learnt_curvature.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace palpate::runtime {
namespace {

constexpr Eigen::Index size = 8;

Eigen::MatrixXd random_matrix(unsigned seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    return Eigen::MatrixXd::NullaryExpr(size, size, [&] { return normal(engine); });
}
Eigen::MatrixXd positive(unsigned seed) {
    const Eigen::MatrixXd M = random_matrix(seed);
    return M * M.transpose() + Eigen::MatrixXd::Identity(size, size);
}

// A potential 1/2 x^T A x and a matrix B near it.
class Learnt : public ::testing::Test {
protected:
    // That the step led from the force at `x` to that at x + way.
    void update(const Eigen::VectorXd& x, const Eigen::VectorXd& step) {
        curvature.update(1, step, -A * x, -A * (x + step));
    }
    Eigen::VectorXd solved(Eigen::VectorXd v) {
        curvature.solve(v, [&](Eigen::VectorXd& u) { u = factor.solve(u); });
        return v;
    }

    Eigen::MatrixXd A = positive(1), B = A + 0.3 * positive(2);
    Eigen::LLT<Eigen::MatrixXd> factor{B};
    LimitedMemoryBfgs curvature{size};
};

TEST_F(Learnt, NothingIsTheMatrixItself) {
    const Eigen::VectorXd v = random_matrix(3).col(0);
    EXPECT_EQ(solved(v), factor.solve(v));
    update(v, random_matrix(4).col(0));
    EXPECT_NE(solved(v), factor.solve(v));
    curvature.forget();
    EXPECT_EQ(solved(v), factor.solve(v));
}

TEST_F(Learnt, ItsLastStepIsKnownExactly) {
    const Eigen::MatrixXd random_steps = random_matrix(5);
    for (Eigen::Index i = 0; i < 20; ++i) {  // more than are kept
        const Eigen::VectorXd step =
            random_steps.col(i % size) + 0.1 * static_cast<double>(i) * random_steps.col((i + 3) % size);
        update(Eigen::VectorXd::Zero(size), step);
        EXPECT_LT((solved(A * step) - step).norm(), 1e-14 * step.norm());  // rounding
    }
    // symmetric and positive
    Eigen::MatrixXd H(size, size);
    for (Eigen::Index i = 0; i < size; ++i) H.col(i) = solved(Eigen::VectorXd::Unit(size, i));
    EXPECT_LT((H - H.transpose()).norm(), 1e-14 * H.norm());  // rounding
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(H).info(), Eigen::Success);
}

TEST_F(Learnt, LeadsToTheLeastOfThePotentialFaster) {
    const Eigen::VectorXd start = random_matrix(6).col(0);
    const auto error_after = [&](int steps, bool learns) {
        curvature.forget();
        Eigen::VectorXd x = start;
        for (int i = 0; i < steps; ++i) {
            const Eigen::VectorXd step = solved(-A * x);
            if (learns) update(x, step);
            x += step;
        }
        return x.norm() / start.norm();
    };
    // By B alone each step leaves a like share; what is learnt of 8 directions ends that after as many (2e-5 here).
    EXPECT_LT(error_after(12, true), 3e-5 * error_after(12, false));
}

TEST_F(Learnt, NothingWhereThePotentialCurvesDownwards) {
    const Eigen::VectorXd v = random_matrix(7).col(0), step = random_matrix(8).col(0);
    curvature.update(1, step, Eigen::VectorXd::Zero(size), step);
    EXPECT_EQ(solved(v), factor.solve(v));
}

}  // namespace
}  // namespace palpate::runtime
