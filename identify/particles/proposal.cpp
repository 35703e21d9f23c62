#include "identify/particles/proposal.h"

#include <cmath>
#include <numbers>

#include "identify/parallel.h"
#include "identify/particles/random.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr int centring_steps = 2;
constexpr int pairs = 8;                           // of draws, the same in each step
constexpr std::uint64_t centring_round = 1 << 30;  // of the random streams, beyond any move's

}  // namespace

Eigen::MatrixXd GaussianProposal::parameters(const Eigen::MatrixXd& z) const {
    // (1 + A)^(-1/2) z = z - V (1 - (1 + values)^(-1/2)) V^T z
    Eigen::MatrixXd v = z;
    if (spectrum.values.size() > 0) {
        const Eigen::VectorXd share = 1 - (1 + spectrum.values.array()).rsqrt();
        v -= spectrum.vectors * (share.asDiagonal() * (spectrum.vectors.transpose() * z));
    }
    return (std::sqrt(wider) * (scale.asDiagonal() * v)).colwise() + mean;
}

double GaussianProposal::log_peak() const {
    const auto P = static_cast<double>(mean.size());
    const double log_root = scale.array().log().sum() + 0.5 * P * std::log(wider) -
                            0.5 * spectrum.values.array().log1p().sum();  // of the covariance's determinant
    return -log_root - 0.5 * P * std::log(2 * std::numbers::pi);
}

GaussianProposal laplace_proposal(const FitResult& fit, const LogNormalPrior& prior) {
    return {fit.theta, prior.sd, fit.spectrum, 1 + 1 / static_cast<double>(fit.theta.size())};
}

int centre(GaussianProposal& proposal, const PositionDomain& domain, const LogNormalPrior& prior,
           const Prediction& near, std::uint64_t seed, int threads) {
    const auto P = static_cast<int>(proposal.mean.size());
    Eigen::MatrixXd z(P, 2 * pairs);
    for (int i = 0; i < pairs; ++i) {
        z.col(2 * i) = RandomStream(seed, centring_round, i).normals(P);
        z.col(2 * i + 1) = -z.col(2 * i);
    }
    for (int step = 0; step < centring_steps; ++step) {
        const Eigen::MatrixXd theta = proposal.parameters(z);
        Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(P, z.cols());
        Eigen::ArrayXi stands = Eigen::ArrayXi::Zero(z.cols());
        for_each_in_parallel(static_cast<int>(z.cols()), threads, [&](int i) {
            try {
                const Prediction prediction = domain.predict(theta.col(i), 1, &near);
                slopes.col(i) = prior.coloured(domain.slopes(theta.col(i), prediction).gradient()) +
                                (theta.col(i) - prior.mean).cwiseQuotient(prior.sd);
                stands[i] = 1;
            } catch (const SolverFailure&) {  // such a body would not stand
            }
        });
        if (stands.sum() == 0) return step + 1;
        const Eigen::VectorXd mean_slope = slopes.rowwise().sum() / stands.sum();
        proposal.mean -= prior.coloured(proposal.spectrum.inverse(1, mean_slope));
    }
    return centring_steps * 2 * pairs;
}

}  // namespace palpate::identify
