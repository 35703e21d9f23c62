#include "identify/diagnosis/likelihood/whitening.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "identify/numerics/random.h"

// Woodbury's formulas against dense matrices.

namespace palpate::identify {
namespace {

constexpr int N = 40, c = 6, p = 3;

struct Example {
    explicit Example(std::uint64_t seed = 5, int nuisances = c) {
        RandomStream random(seed, 0, 0);
        const auto normals = [&](int rows, int columns) {
            const Eigen::VectorXd all = random.normals(rows * columns);
            return Eigen::MatrixXd(all.reshaped(rows, columns));
        };
        A = normals(N, nuisances);
        weights = (1 - 0.7 * normals(N, 1).array().abs().min(1.0)).matrix();
        precisions = normals(nuisances, 1).array().exp().matrix();
        d = 3 * normals(N, 1);
        b = normals(N, p) + A.leftCols(std::min(nuisances, 1)).rowwise().sum() * Eigen::RowVectorXd::Ones(p);
        tau = Vec(0.5, 2, 0.1);
        V = weights.cwiseAbs2().cwiseInverse().asDiagonal();
        if (nuisances > 0) V += A * precisions.cwiseInverse().asDiagonal() * A.transpose();
    }
    static Eigen::VectorXd Vec(double x, double y, double z) { return Eigen::Vector3d(x, y, z); }

    Whitening whitening() const { return {weights, A, precisions}; }

    Eigen::MatrixXd A, b, V;
    Eigen::VectorXd weights, precisions, d, tau;
};

// Rounding of 40 x 40 matrices, whose condition numbers are some 1e3.
constexpr double rounding = 1e-11;

/// ln of the normal density of d, less the constant.
double log_density(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& d) {
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    return -0.5 * d.dot(factor.solve(d)) - factor.matrixLLT().diagonal().array().log().sum();
}

TEST(Whitening, AppliesTheInverseOfV) {
    for (const int nuisances : {0, c}) {
        const Example e(5, nuisances);
        EXPECT_LT((e.whitening().apply(e.b) - e.V.inverse() * e.b).norm(), rounding * e.b.norm());
    }
}

TEST(Whitening, KnowsTheDeterminantOfV) {
    for (const int nuisances : {0, c}) {
        const Example e(5, nuisances);
        const double dense = 2 * e.V.llt().matrixLLT().diagonal().array().log().sum();
        EXPECT_NEAR(e.whitening().log_determinant(), dense, 1e-10);
    }
}

TEST(Whitening, FindsTheMostProbableNuisances) {
    const Example e;
    // z minimises |W (d - A z)|^2 + z^T Lambda z
    const Eigen::MatrixXd W2 = e.weights.cwiseAbs2().asDiagonal(), Lambda = e.precisions.asDiagonal();
    const Eigen::VectorXd z = (e.A.transpose() * W2 * e.A + Lambda).inverse() * e.A.transpose() * W2 * e.d;
    const Eigen::VectorXd found = e.whitening().nuisances(e.d);
    EXPECT_LT((found - z.cwiseProduct(e.precisions.cwiseSqrt())).norm(), rounding * z.norm() * 10);
    EXPECT_LT((e.whitening().residual(e.d) - e.weights.cwiseProduct(e.d - e.A * z)).norm(), rounding * e.d.norm());
}

TEST(Whitening, SplitsChiSquaredIntoResidualAndStrain) {
    const Example e;
    const Whitening V = e.whitening();
    const double chi2 = V.chi_square(e.d);
    EXPECT_NEAR(chi2, V.residual(e.d).squaredNorm() + V.nuisances(e.d).squaredNorm(), rounding * chi2);
}

TEST(Whitening, IsUnsureByTheDiagonalOfVLessTheNoise) {
    for (const int nuisances : {0, c}) {
        const Example e(5, nuisances);
        const Eigen::VectorXd dense = (e.V.diagonal().array() - 1).sqrt();
        EXPECT_LT((e.whitening().nuisance_sd() - dense).norm(), rounding * dense.norm());
    }
}

TEST(Screen, IsTheExactGaussianEvidenceRatio) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        const Example e(seed);
        const Eigen::MatrixXd with = e.V + e.b * e.tau.cwiseAbs2().asDiagonal() * e.b.transpose();
        const ScreenResult said = screen(e.whitening(), e.d, e.b, e.tau);
        EXPECT_NEAR(said.log_bayes_factor, log_density(with, e.d) - log_density(e.V, e.d), 1e-9);

        // the posterior of the numbers
        const Eigen::MatrixXd precision =
            e.b.transpose() * e.V.inverse() * e.b + Eigen::MatrixXd(e.tau.cwiseAbs2().cwiseInverse().asDiagonal());
        const Eigen::VectorXd value = precision.inverse() * e.b.transpose() * e.V.inverse() * e.d;
        EXPECT_LT((said.value - value).norm(), 1e-9 * value.norm());
        EXPECT_LT((said.sd - precision.inverse().diagonal().cwiseSqrt()).norm(), 1e-9 * said.sd.norm());
    }
}

TEST(Screen, KeepsWhatTheNuisancesCannotSwallow) {
    const Example e;
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
    const auto identifiable = [&](const Whitening& V, const Eigen::MatrixXd& b) {
        return screen(V, e.d, b, one).identifiable;
    };
    EXPECT_NEAR(identifiable(Example(5, 0).whitening(), e.b.col(0)), 1, rounding);  // nothing to swallow it

    const Eigen::VectorXd column = e.b.col(0);
    const double dense = column.dot(e.V.inverse() * column) / e.weights.cwiseProduct(column).squaredNorm();
    EXPECT_NEAR(identifiable(e.whitening(), column), dense, rounding);

    // what a nuisance of wide prior does as well is swallowed: of |W b|^2 some 40 a share of 1e-8 is left
    const Whitening wide(e.weights, e.A, 1e-8 * e.precisions);
    EXPECT_LT(identifiable(wide, e.A.col(2)), 1e-8);
}

TEST(Screen, OfAnEffectThatDoesNotShowSaysNothing) {
    const Example e;
    const ScreenResult said = screen(e.whitening(), e.d, Eigen::MatrixXd::Zero(N, p), e.tau);
    EXPECT_EQ(said.log_bayes_factor, 0);
    EXPECT_EQ(said.value.norm(), 0);
    EXPECT_LT((said.sd - e.tau).norm(), rounding);
}

TEST(Screen, OfAlternativesIsTheScreenOfEach) {
    const Example e(3);
    const Whitening V = e.whitening();
    RandomStream random(11, 0, 0);
    constexpr int alternatives = 7;
    for (const int width : {1, 2, 3}) {
        const Eigen::MatrixXd all = random.normals(N * width * alternatives).reshaped(N, width * alternatives);
        const Eigen::VectorXd tau = e.tau.head(width);
        const std::vector<ScreenResult> together = screen_alternatives(V, e.d, all, tau);
        ASSERT_EQ(together.size(), static_cast<std::size_t>(alternatives));
        for (int a = 0; a < alternatives; ++a) {
            const ScreenResult alone = screen(V, e.d, all.middleCols(a * width, width), tau);
            EXPECT_NEAR(together[a].log_bayes_factor, alone.log_bayes_factor, rounding);
            EXPECT_LT((together[a].value - alone.value).norm(), rounding);
            EXPECT_LT((together[a].sd - alone.sd).norm(), rounding);
            EXPECT_NEAR(together[a].identifiable, alone.identifiable, rounding);
        }
    }
}

TEST(Screen, OfNoAlternativesIsNone) {
    const Example e;
    EXPECT_TRUE(screen_alternatives(e.whitening(), e.d, Eigen::MatrixXd(N, 0), e.tau).empty());
}

TEST(Screen, BayesFactorsOfNullsAverageToOne) {
    // E[p(d | effect) / p(d)] = 1 under p(d), whatever the effect. One weak number keeps the variance finite:
    // for tau^2 M = m the second moment of exp(ln BF) is 1 / sqrt(1 - m^2), here with m = 0.5 some 1.15.
    const Example e;
    const Whitening V = e.whitening();
    const Eigen::MatrixXd b = e.b.col(1);
    const double M = b.col(0).dot(V.apply(b).col(0));
    const Eigen::VectorXd tau = Eigen::VectorXd::Constant(1, std::sqrt(0.5 / M));
    const Eigen::MatrixXd L = e.V.llt().matrixL();
    constexpr int draws = 20000;
    double sum = 0;
    RandomStream random(17, 0, 0);
    for (int i = 0; i < draws; ++i) sum += std::exp(screen(V, L * random.normals(N), b, tau).log_bayes_factor);
    const double sd = std::sqrt((1 / std::sqrt(0.75) - 1) / draws);
    EXPECT_NEAR(sum / draws, 1, 4 * sd);  // 4 sigma
}

TEST(LeaveOut, IsTheErrorOfAFitWithoutTheGroup) {
    const Example e;
    std::vector<int> group(N);
    for (int n = 0; n < N; ++n) group[n] = (7 * n) % 5;
    const LeftOutErrors left = leave_out(e.whitening(), e.d, group);
    double chi_square = 0;
    for (int g = 0; g < 5; ++g) {
        std::vector<int> own, others;
        for (int n = 0; n < N; ++n) (group[n] == g ? own : others).push_back(n);
        const Eigen::MatrixXd to_others = e.V(own, others) * e.V(others, others).inverse();
        const Eigen::VectorXd error = e.d(own) - to_others * e.d(others);
        const Eigen::MatrixXd spread = e.V(own, own) - to_others * e.V(others, own);
        EXPECT_LT((left.error(own, 0) - error).norm(), 1e-10 * error.norm()) << g;
        chi_square += error.dot(spread.inverse() * error);
    }
    EXPECT_NEAR(left.chi_square[0], chi_square, 1e-9 * chi_square);
}

TEST(LeaveOut, WhitensErrorsOfTheRightModelToOne) {
    // Of data from V itself the left-out errors of a group are standard normal, once whitened.
    const Example e;
    const Eigen::MatrixXd L = e.V.llt().matrixL();
    std::vector<int> group(N);
    for (int n = 0; n < N; ++n) group[n] = n / 8;
    double sum = 0;
    constexpr int draws = 200;
    RandomStream random(3, 0, 0);
    for (int i = 0; i < draws; ++i) {
        sum += leave_out(e.whitening(), L * random.normals(N), group).chi_square[0];
    }
    // Each group's sum is chi^2 of 8; groups hang together, at most as if they were one: sd sqrt(2 * 5 / 8000).
    EXPECT_NEAR(sum / (draws * N), 1, 4 * std::sqrt(2.0 * 5 / (draws * N)));  // 4 sigma
}

TEST(OneSidedEvidence, IsThatOfHalfThePriorFarFromZero) {
    // d ~ N(x, 1) with x ~ N(0, tau^2): ln BF = d^2 tau^2 / (1 + tau^2) / 2 - ln(1 + tau^2) / 2. With x > 0 alone it is
    // that and ln(2 Phi(mean / sd)) of the posterior, by d = 5 sigmas ln 2 to 1e-6.
    const double d = 5, tau = 10, share = tau * tau / (1 + tau * tau);
    const double symmetric = 0.5 * d * d * share - 0.5 * std::log1p(tau * tau);
    const double mean = share * d, sd = std::sqrt(share);
    const double exact = symmetric + std::log(std::erfc(-mean / sd / std::sqrt(2.0)));
    EXPECT_NEAR(one_sided_evidence(symmetric, mean), exact, 1e-6);
}

TEST(OneSidedEvidence, RefusesWhatIsBelowZero) {
    EXPECT_LT(one_sided_evidence(1000, -1e-3), -40);
    EXPECT_TRUE(std::isfinite(one_sided_evidence(1000, -1)));
}

}  // namespace
}  // namespace palpate::identify
