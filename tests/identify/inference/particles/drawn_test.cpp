#include "identify/inference/particles/drawn.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

/// Readings y = J theta + N(0, 1) and a prior that makes neighbours on a chain alike: the posterior is Gaussian, and
/// known.
struct Linear {
    static constexpr int P = 40, readings = 12;
    Eigen::MatrixXd J = Eigen::MatrixXd(readings, P);
    Eigen::VectorXd y = RandomStream(4, 0, 0).normals(readings);
    LogNormalPrior prior;
    Eigen::MatrixXd covariance;
    GaussianProposal posterior;

    Linear() {
        for (int p = 0; p < P; ++p) J.col(p) = RandomStream(5, 0, p).normals(readings);
        std::vector<MarkovField::Edge> chain;
        for (int p = 0; p + 1 < P; ++p) chain.push_back({p, p + 1, 1});
        prior = {Eigen::VectorXd::Zero(P), Eigen::VectorXd::Constant(P, 0.7),
                 std::make_shared<MarkovField>(P, chain, 1)};
        const Eigen::MatrixXd precision = J.transpose() * J + Eigen::MatrixXd(prior.precision());
        covariance = precision.llt().solve(Eigen::MatrixXd::Identity(P, P));

        const Eigen::MatrixXd by_v = prior.gradients_by_v(J.transpose());
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(by_v * by_v.transpose());
        posterior = {covariance * J.transpose() * y,
                     prior,
                     {eigen.eigenvalues().tail(readings).reverse(),
                      eigen.eigenvectors().rightCols(readings).rowwise().reverse()},
                     1};
    }
    double log_density(const Eigen::VectorXd& theta) const {
        return -(y - J * theta).squaredNorm() / 2 + prior.log_density(theta);
    }
    TemperedResult particles(const GaussianProposal& proposal, int count) const {
        return laplace_particles([&](const Eigen::VectorXd& theta) { return log_density(theta); }, proposal,
                                 {.particles = count});
    }
};

Eigen::VectorXd sd_of(const Eigen::MatrixXd& particles) {
    const Eigen::MatrixXd off = particles.rowwise() - particles.colwise().mean();
    return (off.colwise().squaredNorm() / static_cast<double>(particles.rows())).cwiseSqrt();
}

TEST(DrawnParticles, AreThePosteriorOfLinearReadings) {
    const Linear linear;
    constexpr int N = 4000;
    const TemperedResult drawn = linear.particles(linear.posterior, N);
    const Eigen::VectorXd sd = linear.covariance.diagonal().cwiseSqrt();
    const Eigen::VectorXd off = drawn.particles.colwise().mean().transpose() - linear.posterior.mean;
    for (int p = 0; p < Linear::P; ++p) {
        // five sigma of a mean, and of an sd
        EXPECT_LT(std::abs(off[p]), 5 * sd[p] / std::sqrt(N)) << p;
        EXPECT_NEAR(sd_of(drawn.particles)[p] / sd[p], 1, 5 / std::sqrt(2.0 * N)) << p;
    }
    // the integral over theta is known: y ~ N(0, 1 + J C C^T J^T)
    const Eigen::MatrixXd S =
        Eigen::MatrixXd::Identity(12, 12) +
        linear.J * Eigen::MatrixXd(linear.prior.coloured(linear.prior.gradients_by_v(linear.J.transpose())));
    const Eigen::LLT<Eigen::MatrixXd> llt(S);
    const double log_determinant = 2 * Eigen::MatrixXd(llt.matrixL()).diagonal().array().log().sum();
    EXPECT_NEAR(drawn.log_evidence, -(linear.y.dot(llt.solve(linear.y)) + log_determinant) / 2, 1e-9);  // rounding
    EXPECT_NEAR(drawn.log_density[7], linear.log_density(drawn.particles.row(7)), 1e-9);
}

TEST(DrawnParticles, DirectionsThatAreLeftOutMakeThemWider) {
    const Linear linear;
    GaussianProposal few = linear.posterior;
    few.spectrum.values = few.spectrum.values.head(6).eval();
    few.spectrum.vectors = few.spectrum.vectors.leftCols(6).eval();
    constexpr int N = 4000;
    const Eigen::VectorXd sd = sd_of(linear.particles(few, N).particles);
    const Eigen::VectorXd exact = linear.covariance.diagonal().cwiseSqrt();
    for (int p = 0; p < Linear::P; ++p) {
        EXPECT_GT(sd[p], exact[p] * (1 - 5 / std::sqrt(2.0 * N))) << p;  // five sigma
        EXPECT_LT(sd[p], 0.7 * (1 + 5 / std::sqrt(2.0 * N))) << p;       // the prior's
    }
    EXPECT_GT(sd.mean(), 1.02 * exact.mean());
}

}  // namespace
}  // namespace palpate::identify
