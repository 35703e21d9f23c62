#include "fem/elements/shape.h"

#include <gtest/gtest.h>

#include <random>
#include <span>

namespace palpate::fem {
namespace {

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

/// Largest error over all monomials l0^a l1^b l2^c l3^d of a degree; exact mean: a! b! c! d! 3! / (a+b+c+d+3)!.
double worst_error(std::span<const QuadraturePoint> rule, int degree) {
    double worst = 0;
    for (int a = 0; a <= degree; ++a) {
        for (int b = 0; a + b <= degree; ++b) {
            for (int c = 0; a + b + c <= degree; ++c) {
                const int d = degree - a - b - c;
                double sum = 0;
                for (const auto& [l, weight] : rule) {
                    sum += weight * std::pow(l(0), a) * std::pow(l(1), b) * std::pow(l(2), c) * std::pow(l(3), d);
                }
                const double exact =
                    factorial(a) * factorial(b) * factorial(c) * factorial(d) * 6 / factorial(degree + 3);
                worst = std::max(worst, std::abs(sum - exact));
            }
        }
    }
    return worst;
}

TEST(Quadrature, IsExactToItsDegreeAndNotBeyond) {
    // Rounding of 20-digit constants; a wrong rule is off by more than 1e-5.
    for (int degree = 0; degree <= 2; ++degree) EXPECT_LT(worst_error(quadrature_2(), degree), 1e-15) << degree;
    for (int degree = 0; degree <= 5; ++degree) EXPECT_LT(worst_error(quadrature_5(), degree), 1e-15) << degree;
    EXPECT_GT(worst_error(quadrature_2(), 3), 1e-5);
    EXPECT_GT(worst_error(quadrature_5(), 6), 1e-6);
}

TEST(Shape, IsOneAtItsNodeAndZeroAtTheOthers) {
    for (int k = 0; k < 10; ++k) {
        Eigen::Vector4d l = Eigen::Vector4d::Zero();
        if (k < 4) {
            l(k) = 1;
        } else {
            for (const int corner : edge_corners[k - 4]) l(corner) = 0.5;
        }
        const Eigen::Matrix<double, 10, 1> expected = Eigen::Matrix<double, 10, 1>::Unit(k);
        EXPECT_EQ((shape<4, 10>(l)), expected) << k;
    }
}

TEST(Shape, GradientIsTheDerivative) {
    // Central differences of a quadratic are exact but for rounding, 1e-16 over the step.
    constexpr double step = 1e-3;
    const Eigen::Vector4d l(0.1, 0.2, 0.3, 0.4);
    const auto gradient = shape_gradient<4, 10>(l);
    for (int a = 1; a < 4; ++a) {
        const Eigen::Vector4d along = Eigen::Vector4d::Unit(a) - Eigen::Vector4d::Unit(0);
        const Eigen::Matrix<double, 10, 1> difference =
            (shape<4, 10>(l + step * along) - shape<4, 10>(l - step * along)) / (2 * step);
        EXPECT_LT((gradient.col(a - 1) - difference).cwiseAbs().maxCoeff(), 1e-12);
    }
}

}  // namespace
}  // namespace palpate::fem
