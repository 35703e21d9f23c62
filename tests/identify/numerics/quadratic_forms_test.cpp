#include "identify/numerics/quadratic_forms.h"

#include <gtest/gtest.h>

#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

/// H = R^T R (P x P), of which blocks (i, j) are kept where |i - j| <= band.
Eigen::SparseMatrix<double> banded(int P, int band, int block) {
    Eigen::MatrixXd R(P, P);
    for (int p = 0; p < P; ++p) R.col(p) = RandomStream(1, 0, p).normals(P);
    Eigen::MatrixXd H = R.transpose() * R;
    for (int i = 0; i < P; ++i) {
        for (int j = 0; j < P; ++j) {
            if (std::abs(i / block - j / block) > band) H(i, j) = 0;
        }
    }
    return H.sparseView();
}

struct Shape {
    const char* what;
    int P, band, N, block = 1;
};

class QuadraticForms : public testing::TestWithParam<Shape> {};

TEST_P(QuadraticForms, AreThoseOfEachParticleAlone) {
    const auto [what, P, band, N, block] = GetParam();
    const Eigen::SparseMatrix<double> H = banded(P, band, block);
    const Eigen::VectorXd g = RandomStream(2, 0, 0).normals(P);
    Eigen::MatrixXd X(N, P);
    for (int p = 0; p < P; ++p) X.col(p) = RandomStream(3, 0, p).normals(N);
    const Eigen::VectorXd forms = quadratic_forms(H, g, X);
    ASSERT_EQ(forms.size(), N);
    for (int i = 0; i < N; ++i) {
        const Eigen::VectorXd x = X.row(i);
        // rounding of P^2 products
        EXPECT_NEAR(forms[i], x.dot(H * x) + 2 * g.dot(x), 1e-12 * P * P) << i;
    }
}

INSTANTIATE_TEST_SUITE_P(, QuadraticForms,
                         testing::Values(Shape{"few_whole_strips", 6, 6, 64}, Shape{"few_with_a_rest", 6, 6, 77},
                                         Shape{"fewer_than_a_strip", 3, 3, 5}, Shape{"one", 1, 1, 40},
                                         Shape{"as_many_as_registers_hold", 8, 8, 33}, Shape{"one_more", 9, 9, 33},
                                         Shape{"sparse", 120, 4, 70}, Shape{"pairs_with_the_same_rows", 121, 3, 70, 2},
                                         Shape{"threes_with_the_same_rows", 120, 2, 70, 3},
                                         Shape{"dense", 50, 50, 1030}),
                         [](const auto& tested) { return tested.param.what; });

TEST(QuadraticForm, OfAMissingDiagonal) {
    Eigen::SparseMatrix<double> H(2, 2);
    H.insert(0, 1) = H.insert(1, 0) = 3;
    const Eigen::MatrixXd X = Eigen::RowVector2d(2, 5);
    EXPECT_DOUBLE_EQ(quadratic_forms(H, Eigen::Vector2d::Zero(), X)[0], 60);
}

}  // namespace
}  // namespace palpate::identify
