#include "identify/particles/proposal.h"

#include <cmath>
#include <numbers>

#include "identify/parallel.h"
#include "identify/particles/random.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr int centring_looks = 4;                  // at the posterior's slopes, at most
constexpr double centred = 0.1;                    // of ln pi, that the next step would gain
constexpr std::uint64_t centring_round = 1 << 30;  // of the random streams, beyond any move's

/// ln pi of a domain and a prior, and its slopes by v, theta = mean + C v; averages over draws of a proposal.
struct Look {
    int stands = 0;            // draws with an equilibrium
    double log_density = 0;    // mean over them, but for a constant
    Eigen::VectorXd downhill;  // (P)
};

Look look_round(const Eigen::MatrixXd& theta, const PositionDomain& domain, const LogNormalPrior& prior,
                const Prediction& near, int threads) {
    Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(theta.rows(), theta.cols());
    Eigen::ArrayXd log_density = Eigen::ArrayXd::Zero(theta.cols());
    Eigen::ArrayXi stands = Eigen::ArrayXi::Zero(theta.cols());
    for_each_in_parallel(static_cast<int>(theta.cols()), threads, [&](int i) {
        try {
            const Prediction prediction = domain.predict(theta.col(i), 1, &near);
            slopes.col(i) =
                prior.slopes_by_v(domain.slopes(theta.col(i), prediction).gradient()) + prior.whitened(theta.col(i));
            log_density[i] = -domain.chi_squared(prediction) / 2 - prior.half_square(theta.col(i));
            stands[i] = 1;
        } catch (const SolverFailure&) {  // such a body would not stand
        }
    });
    Look look;
    look.stands = stands.sum();
    if (look.stands == 0) return look;
    look.log_density = log_density.sum() / look.stands;
    look.downhill = slopes.rowwise().sum() / look.stands;
    return look;
}

}  // namespace

Eigen::MatrixXd GaussianProposal::parameters(const Eigen::MatrixXd& z) const {
    // (1 + A)^(-1/2) z = z - V (1 - (1 + values)^(-1/2)) V^T z
    Eigen::MatrixXd v = z;
    if (spectrum.values.size() > 0) {
        const Eigen::VectorXd share = 1 - (1 + spectrum.values.array()).rsqrt();
        v -= spectrum.vectors * (share.asDiagonal() * (spectrum.vectors.transpose() * z));
    }
    return (std::sqrt(wider) * prior.coloured(v)).colwise() + mean;
}

Eigen::VectorXd GaussianProposal::whitened(const Eigen::VectorXd& theta) const {
    // (1 + A)^(1/2) v = v + V ((1 + values)^(1/2) - 1) V^T v
    Eigen::VectorXd v = prior.whitened(theta - mean + prior.mean);
    if (spectrum.values.size() > 0) {
        const Eigen::VectorXd share = (1 + spectrum.values.array()).sqrt() - 1;
        v += spectrum.vectors * (share.asDiagonal() * (spectrum.vectors.transpose() * v));
    }
    return v / std::sqrt(wider);
}

double GaussianProposal::log_peak() const {
    const auto P = static_cast<double>(mean.size());
    const double log_root = prior.log_root() + 0.5 * P * std::log(wider) -
                            0.5 * spectrum.values.array().log1p().sum();  // of the covariance's determinant
    return -log_root - 0.5 * P * std::log(2 * std::numbers::pi);
}

GaussianProposal laplace_proposal(const FitResult& fit, const LogNormalPrior& prior) {
    return {fit.theta, prior, fit.spectrum, 1 + 1 / static_cast<double>(fit.theta.size())};
}

int centre(Eigen::VectorXd& mean, const Eigen::MatrixXd& offsets,
           const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& covariance, const PositionDomain& domain,
           const LogNormalPrior& prior, const Prediction& near, int threads) {
    Eigen::MatrixXd both(offsets.rows(), 2 * offsets.cols());
    for (Eigen::Index i = 0; i < offsets.cols(); ++i) {
        both.col(2 * i) = offsets.col(i);
        both.col(2 * i + 1) = -offsets.col(i);
    }
    const auto look_from = [&](const Eigen::VectorXd& middle) {
        return look_round(both.colwise() + middle, domain, prior, near, threads);
    };
    Look here = look_from(mean);
    int looks = 1;
    double share = 1;
    while (here.stands > 0 && looks < centring_looks) {
        const Eigen::VectorXd step = covariance(here.downhill);
        if (share * here.downhill.dot(step) < centred) break;
        const Eigen::VectorXd there = mean - share * prior.coloured(step);
        Look look = look_from(there);
        ++looks;
        if (look.stands >= here.stands && look.log_density > here.log_density) {
            mean = there;
            here = std::move(look);
        } else {
            share /= 4;
        }
    }
    return looks * static_cast<int>(both.cols());
}

int centre(GaussianProposal& proposal, const PositionDomain& domain, const LogNormalPrior& prior,
           const Prediction& near, int pairs, std::uint64_t seed, int threads) {
    const auto P = static_cast<int>(proposal.mean.size());
    Eigen::MatrixXd z(P, pairs);
    for (int i = 0; i < pairs; ++i) z.col(i) = RandomStream(seed, centring_round, i).normals(P);
    const Eigen::MatrixXd offsets = proposal.parameters(z).colwise() - proposal.mean;
    return centre(
        proposal.mean, offsets,
        [&](const Eigen::VectorXd& downhill) -> Eigen::VectorXd { return proposal.spectrum.inverse(1, downhill); },
        domain, prior, near, threads);
}

}  // namespace palpate::identify
