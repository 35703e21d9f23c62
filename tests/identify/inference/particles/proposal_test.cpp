#include "identify/inference/particles/proposal.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "identify/identify.h"
#include "identify/inference/particles/resampling.h"
#include "identify/numerics/random.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

TEST(GaussianProposal, HasTheCovarianceThatItSays) {
    constexpr int P = 6;
    Eigen::MatrixXd R(P, P);
    for (int p = 0; p < P; ++p) R.col(p) = RandomStream(2, 0, p).normals(P);
    const Eigen::MatrixXd A = R * R.transpose();
    GaussianProposal proposal{Eigen::VectorXd::LinSpaced(P, -1, 1),
                              {Eigen::VectorXd::Zero(P), Eigen::VectorXd::LinSpaced(P, 0.5, 2), nullptr},
                              leading_spectrum([&](const Eigen::MatrixXd& V) { return A * V; }, P),
                              1.5};

    const Eigen::MatrixXd root = proposal.parameters(Eigen::MatrixXd::Identity(P, P)).colwise() -
                                 proposal.parameters(Eigen::VectorXd::Zero(P)).col(0);
    const Eigen::MatrixXd S = proposal.prior.sd.asDiagonal();
    const Eigen::MatrixXd covariance = 1.5 * S * (A + Eigen::MatrixXd::Identity(P, P)).inverse() * S;
    EXPECT_LT((root * root.transpose() - covariance).norm(), 1e-12 * covariance.norm() * 100);  // rounding
    EXPECT_NEAR(proposal.log_peak(),
                -0.5 * std::log(covariance.determinant()) - 0.5 * P * std::log(2 * std::numbers::pi), 1e-9);
    EXPECT_EQ(proposal.parameters(Eigen::VectorXd::Zero(P)), proposal.mean);
}

TEST(GaussianMixture, HasTheSameDensityFromWhicheverGaussianAPlaceIsTold) {
    constexpr int P = 3;
    const auto at = [](double mean, double sd) {
        return GaussianProposal{Eigen::VectorXd::Constant(P, mean),
                                {Eigen::VectorXd::Zero(P), Eigen::VectorXd::Constant(P, sd), nullptr},
                                {},
                                1};
    };
    const std::vector<GaussianProposal> parts{at(-1, 0.5), at(2, 1.5)};
    const GaussianMixture mixture(parts);
    ASSERT_EQ(mixture.modes(), 2);
    ASSERT_EQ(mixture.dimension(), P);

    const Eigen::MatrixXd z = RandomStream(3, 0, 0).normals(P);
    const Eigen::VectorXd theta = mixture.parameters(z, {0}).col(0);
    EXPECT_EQ(theta, parts[0].parameters(z).col(0));
    const double density = mixture.log_density(theta, z.col(0), 0);
    EXPECT_NEAR(density, mixture.log_density(theta, parts[1].whitened(theta), 1), 1e-12);  // rounding
    const Eigen::VectorXd each = mixture.log_densities(theta, z.col(0), 0);
    EXPECT_NEAR(std::exp(density), each.array().exp().mean(), 1e-12);
}

/// A block whose links are stiff and soft at random, each to be found from what moves at its spheres.
struct ManyLinks {
    skeleton::Model model = with_law(make_lattice({6, 4, 4}), skeleton::EquilibriumLaw::linear);
    MeasurementSet set;
    PositionDomain domain;
    LogNormalPrior prior;
    FitResult fit;

    ManyLinks() : set(measured()), domain(make_domain()) {
        domain.set_model_error(0.15);
        const int P = domain.parameters().size();
        prior = {Eigen::VectorXd::Zero(P), Eigen::VectorXd::Constant(P, 0.7), nullptr};
        fit = fit_map(domain, prior, prior.mean, 2);
    }

    MeasurementSet measured() const {
        skeleton::Model truth = model;
        for (std::size_t l = 0; l < truth.links.size(); ++l) {
            const Eigen::VectorXd z = RandomStream(3, 0, l).normals(3);
            truth.links[l].stiffness = truth.links[l].stiffness.array() * (0.7 * z.array()).exp();
        }
        return simulate_measurements(truth, push_spheres(truth, six_forces(2, 8)), markers_on_spheres(truth), 0.01);
    }
    PositionDomain make_domain() const {
        return {model, model.law, group_stiffness(model, Scope::links), collect_readings(model, set), 2};
    }

    double log_density(const Eigen::VectorXd& theta) const {
        return prior.log_density(theta) - 0.5 * domain.chi_squared(domain.predict(theta, 1));
    }
    /// Mean over draws.
    double log_density(const GaussianProposal& proposal) const {
        double sum = 0;
        for (int i = 0; i < 50; ++i) {
            sum += log_density(proposal.parameters(RandomStream(7, 1, i).normals(domain.parameters().size())).col(0));
        }
        return sum / 50;
    }
    double effective_share(const GaussianProposal& proposal) const {
        constexpr int n = 100;
        Eigen::VectorXd log_weights(n);
        for (int i = 0; i < n; ++i) {
            const Eigen::VectorXd z = RandomStream(7, 0, i).normals(domain.parameters().size());
            log_weights[i] = log_density(proposal.parameters(z)) + z.squaredNorm() / 2;
        }
        normalise(log_weights);
        return effective_samples(log_weights) / n;
    }
};

TEST(Centre, HundredsOfLinksAreWeighedWhereLaplaceMisses) {
    const ManyLinks body;
    GaussianProposal proposal = laplace_proposal(body.fit, body.prior);
    const double by_laplace = body.effective_share(proposal), density = body.log_density(proposal);
    centre(proposal, body.domain, body.prior, body.fit, 8, 1, 2);
    EXPECT_LT(by_laplace, 0.15);
    EXPECT_GT(body.effective_share(proposal), 1.7 * by_laplace);
    EXPECT_GT(body.log_density(proposal), density + 0.5);
}

TEST(Centre, KeepsAGaussianPosteriorsMean) {
    // where all is linear, slopes at z and -z cancel
    const skeleton::Model model = with_law(make_lattice({3, 1, 1}), skeleton::EquilibriumLaw::linear);
    const MeasurementSet set =
        simulate_measurements(model, push_spheres(model, six_forces(0.1, 1)), markers_on_spheres(model), 1e-6);
    PositionDomain domain(model, model.law, group_stiffness(model, Scope::uniform), collect_readings(model, set), 1);
    domain.set_model_error(1e-4);
    const LogNormalPrior prior{Eigen::VectorXd::Zero(3), Eigen::VectorXd::Constant(3, 1e-5), nullptr};
    const FitResult fit = fit_map(domain, prior, prior.mean, 1);
    GaussianProposal proposal = laplace_proposal(fit, prior);
    centre(proposal, domain, prior, fit, 8, 1, 1);
    EXPECT_LT((proposal.mean - fit.theta).norm(), 1e-3 * 1e-5);  // of the prior's sd
}

}  // namespace
}  // namespace palpate::identify
