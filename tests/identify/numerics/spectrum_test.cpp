#include "identify/numerics/spectrum.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

/// Q diag(values, 0, ...) Q^T of orthonormal columns drawn at random.
Eigen::MatrixXd matrix_of(const Eigen::VectorXd& values, int P) {
    Eigen::MatrixXd Q(P, values.size());
    for (Eigen::Index i = 0; i < values.size(); ++i) Q.col(i) = RandomStream(4, 0, i).normals(P);
    Q = Eigen::HouseholderQR<Eigen::MatrixXd>(Q).householderQ() * Eigen::MatrixXd::Identity(P, values.size());
    return Q * values.asDiagonal() * Q.transpose();
}

Eigen::VectorXd falling(int count) {  // 1e4, ... each 0.7 of the one before
    return 1e4 * Eigen::VectorXd::LinSpaced(count, 0, count - 1).unaryExpr([](double i) { return std::pow(0.7, i); });
}

TEST(LeadingSpectrum, FindsAllEigenvaluesAboveTheLeast) {
    for (const int P : {60, 700}) {
        const Eigen::VectorXd values = falling(50);
        const Eigen::MatrixXd A = matrix_of(values, P);
        const SpectrumOptions options{.least = 0.05, .residual = 1e-6};
        const Spectrum found = leading_spectrum([&](const Eigen::MatrixXd& V) { return A * V; }, P, options);
        const auto sought = (values.array() >= options.least).count();
        ASSERT_GE(found.values.size(), sought);
        // an eigenvalue is off by the residual's square; the last ones by rounding of the largest
        for (Eigen::Index i = 0; i < sought; ++i) EXPECT_NEAR(found.values[i], values[i], 1e-9 * values[0]) << P;
        const auto r = found.values.size();
        EXPECT_LT((found.vectors.transpose() * found.vectors - Eigen::MatrixXd::Identity(r, r)).norm(), 1e-9);
    }
}

TEST(LeadingSpectrum, FindsEqualOnesAsOftenAsTheyOccur) {
    // as symmetric bodies have them; no more of them than columns multiplied at once
    const Eigen::VectorXd values = Eigen::VectorXd::Constant(6, 7);
    const Eigen::MatrixXd A = matrix_of(values, 500);
    const Spectrum found = leading_spectrum([&](const Eigen::MatrixXd& V) { return A * V; }, 500);
    ASSERT_EQ(found.values.size(), 6);
    EXPECT_LT((found.values - values).norm(), 1e-9);
    EXPECT_NEAR(found.effective(), 6 * 7.0 / 8, 1e-9);
}

TEST(LeadingSpectrum, StartsFromWhatIsKnown) {
    const Eigen::MatrixXd A = matrix_of(falling(50), 700);
    int products = 0;
    const SymmetricProduct times = [&](const Eigen::MatrixXd& V) {
        products += static_cast<int>(V.cols());
        return A * V;
    };
    const Spectrum first = leading_spectrum(times, 700);
    const int from_nothing = products;
    products = 0;
    leading_spectrum(times, 700, {}, first.vectors);
    EXPECT_LT(products, 0.8 * from_nothing);
}

TEST(LeadingSpectrum, NothingToFindIsNothing) {
    const Spectrum none = leading_spectrum([](const Eigen::MatrixXd& V) { return 1e-3 * V; }, 300);
    EXPECT_EQ(none.values.size(), 0);
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(300, 0, 1);
    EXPECT_EQ(none.inverse(1, x), x);
}

TEST(Spectrum, InvertsWithAShift) {
    const Eigen::MatrixXd A = matrix_of(falling(20), 40);
    const Spectrum whole = leading_spectrum([&](const Eigen::MatrixXd& V) { return A * V; }, 40);
    const Eigen::VectorXd x = RandomStream(5, 0, 0).normals(40);
    const Eigen::VectorXd y = whole.inverse(3, x);
    EXPECT_LT((3 * y + A * y - x).norm(), 1e-10 * x.norm() * 1e4);  // rounding of the largest eigenvalue
}

}  // namespace
}  // namespace palpate::identify
