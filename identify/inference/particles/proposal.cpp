#include "identify/inference/particles/proposal.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "identify/numerics/parallel.h"
#include "identify/numerics/random.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr int centring_evaluations = 3;            // at pairs of draws, at most
constexpr double centred = 0.1;                    // of ln pi, that the next step would gain,
constexpr double centred_each = 1e-3;              // or so much for each number
constexpr std::uint64_t centring_round = 1 << 30;  // of the random streams, beyond any move's

/// (1 + A)^(-1/2) Z = Z - V (1 - (1 + values)^(-1/2)) V^T Z
Eigen::MatrixXd narrowed(const Spectrum& spectrum, const Eigen::MatrixXd& Z) {
    if (spectrum.values.size() == 0) return Z;
    const Eigen::VectorXd share = 1 - (1 + spectrum.values.array()).rsqrt();
    return Z - spectrum.vectors * (share.asDiagonal() * (spectrum.vectors.transpose() * Z));
}

/// Averages over pairs of draws on either side of a mean.
struct PairAverages {
    int stand = 0;                        // pairs with equilibria
    double log_density = 0;               // ln pi, but for a constant
    std::vector<Eigen::MatrixXd> errors;  // of each state, over sigma (3m x 1)
};

/// Of draws mean +- offsets. `like`: has as many errors, and their weights.
PairAverages look_round(const Eigen::VectorXd& mean, const Eigen::MatrixXd& offsets, const ErrorJacobian& like,
                        const PositionDomain& domain, const LogNormalPrior& prior, const Prediction& near,
                        int threads) {
    std::vector<PairAverages> pairs(static_cast<std::size_t>(offsets.cols()));
    const auto add = [&](const Eigen::VectorXd& theta, PairAverages& to) {
        const Prediction prediction = domain.predict(theta, 1, &near);
        to.log_density -= domain.chi_squared(prediction) / 2 + prior.half_square(theta);
        for (int s = 0; s < like.count_read(); ++s) {
            to.errors[s] += like.weights(s).cwiseSqrt().cwiseProduct(domain.errors(s, prediction.markers[s]));
        }
    };
    PairAverages look;
    look.errors.resize(static_cast<std::size_t>(like.count_read()));
    for (int s = 0; s < like.count_read(); ++s) look.errors[s].setZero(like.weights(s).size(), 1);
    for_each_in_parallel(static_cast<int>(pairs.size()), threads, [&](int i) {
        pairs[i].errors = look.errors;
        try {
            add(mean + offsets.col(i), pairs[i]);
            add(mean - offsets.col(i), pairs[i]);
            pairs[i].stand = 1;
        } catch (const SolverFailure&) {  // such a body would not stand
        }
    });
    for (const PairAverages& pair : pairs) {
        if (pair.stand == 0) continue;
        ++look.stand;
        look.log_density += pair.log_density;
        for (std::size_t s = 0; s < look.errors.size(); ++s) look.errors[s] += pair.errors[s];
    }
    const double draws = 2.0 * look.stand;
    look.log_density /= draws;
    for (Eigen::MatrixXd& errors : look.errors) errors /= draws;
    return look;
}

}  // namespace

Eigen::MatrixXd GaussianProposal::parameters(const Eigen::MatrixXd& z) const {
    return (std::sqrt(wider) * prior.coloured(narrowed(spectrum, z))).colwise() + mean;
}

Eigen::MatrixXd GaussianProposal::gradients_by_z(const Eigen::MatrixXd& gradients) const {
    return std::sqrt(wider) * narrowed(spectrum, prior.gradients_by_v(gradients));
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

GaussianMixture::GaussianMixture(const std::vector<GaussianProposal>& parts) : parts_(parts) {
    for (const GaussianProposal& part : parts) log_peaks_.push_back(part.log_peak());
}

Eigen::MatrixXd GaussianMixture::parameters(const Eigen::MatrixXd& z, const std::vector<int>& from) const {
    Eigen::MatrixXd theta(z.rows(), z.cols());
    for (int k = 0; k < modes(); ++k) {
        std::vector<int> of_k;
        for (int i = 0; i < static_cast<int>(from.size()); ++i) {
            if (from[i] == k) of_k.push_back(i);
        }
        theta(Eigen::all, of_k) = parts_[k].parameters(z(Eigen::all, of_k));
    }
    return theta;
}

Eigen::VectorXd GaussianMixture::log_densities(const Eigen::VectorXd& theta, const Eigen::VectorXd& z, int from) const {
    Eigen::VectorXd log_q(modes());
    for (int k = 0; k < modes(); ++k) {
        log_q[k] = log_peaks_[k] - (k == from ? z.squaredNorm() : parts_[k].whitened(theta).squaredNorm()) / 2;
    }
    return log_q;
}

double GaussianMixture::log_density(const Eigen::VectorXd& theta, const Eigen::VectorXd& z, int from) const {
    const Eigen::VectorXd log_q = log_densities(theta, z, from);
    const double largest = log_q.maxCoeff();
    return largest + std::log((log_q.array() - largest).exp().mean());
}

GaussianProposal laplace_proposal(const FitResult& fit, const LogNormalPrior& prior) {
    return {fit.theta, prior, fit.spectrum, 1 + 1 / static_cast<double>(fit.theta.size())};
}

int centre(Eigen::VectorXd& mean, const Eigen::MatrixXd& offsets, const ErrorJacobian& jacobian,
           const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& covariance, const PositionDomain& domain,
           const LogNormalPrior& prior, const FitResult& fit, int threads) {
    const double enough = std::max(centred, centred_each * static_cast<double>(mean.size()));
    const auto look_from = [&](const Eigen::VectorXd& middle) {
        return look_round(middle, offsets, jacobian, domain, prior, fit.prediction, threads);
    };
    PairAverages here = look_from(mean);
    int evaluations = 1;
    double share = 1;
    while (here.stand > 0 && evaluations < centring_evaluations) {
        const Eigen::VectorXd downhill =
            prior.gradients_by_v(jacobian.transposed_times(here.errors)) + prior.whitened(mean);
        const Eigen::VectorXd step = covariance(downhill);
        if (share * downhill.dot(step) < enough) break;
        const Eigen::VectorXd there = mean - share * prior.coloured(step);
        PairAverages look = look_from(there);
        ++evaluations;
        if (look.stand >= here.stand && look.log_density > here.log_density) {
            mean = there;
            here = std::move(look);
        } else {
            share /= 4;
        }
    }
    return evaluations * 2 * static_cast<int>(offsets.cols());
}

int centre(GaussianProposal& proposal, const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
           int pairs, std::uint64_t seed, int threads) {
    const auto P = static_cast<int>(proposal.mean.size());
    Eigen::MatrixXd z(P, pairs);
    for (int i = 0; i < pairs; ++i) z.col(i) = RandomStream(seed, centring_round, i).normals(P);
    const Eigen::MatrixXd offsets = proposal.parameters(z).colwise() - proposal.mean;
    const ErrorJacobian jacobian =
        domain.jacobian(fit.theta, domain.predict(fit.theta, threads, &fit.prediction, true));
    return centre(
        proposal.mean, offsets, jacobian,
        [&](const Eigen::VectorXd& downhill) -> Eigen::VectorXd { return proposal.spectrum.inverse(1, downhill); },
        domain, prior, fit, threads);
}

}  // namespace palpate::identify
