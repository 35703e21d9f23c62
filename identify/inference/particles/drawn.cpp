#include "identify/inference/particles/drawn.h"

#include <algorithm>
#include <cmath>

#include "identify/numerics/random.h"

namespace palpate::identify {

namespace {

constexpr int least_independent = 24;       // an sd from so many is known to 15 %, 1 / sqrt(2 * 23)
constexpr double most_drawn_numbers = 2e5;  // of independent draws

/// Particles that are not weighed (N x P), each less likely than the mean by half a square (N).
TemperedResult unweighed(Eigen::MatrixXd particles, const Eigen::ArrayXd& half_squares, double at_mean,
                         const GaussianProposal& proposal) {
    const Eigen::Index N = particles.rows();
    TemperedResult result;
    result.particles = std::move(particles);
    result.log_weights = Eigen::VectorXd::Constant(N, -std::log(N));
    result.log_evidence = at_mean - proposal.log_peak();
    result.log_density = at_mean - half_squares;
    result.mode.assign(static_cast<std::size_t>(N), 0);
    result.weighed = false;
    result.evaluations = 1;
    result.history.push_back({1, static_cast<double>(N), result.particles, result.log_weights});
    return result;
}

}  // namespace

TemperedResult laplace_particles(const LogDensity& log_density, const GaussianProposal& proposal,
                                 const TemperedOptions& options) {
    const auto P = static_cast<int>(proposal.mean.size());
    Eigen::MatrixXd z(P, options.particles);
    for (int i = 0; i < options.particles; ++i) z.col(i) = RandomStream(options.seed, 0, i).normals(P);
    return unweighed(proposal.parameters(z).transpose(), z.colwise().squaredNorm().transpose() / 2,
                     log_density(proposal.mean), proposal);
}

int independent_draws(int parameters, int particles) {
    return std::clamp(static_cast<int>(most_drawn_numbers / parameters), std::min(least_independent, particles),
                      particles);
}

TemperedResult perturbed_particles(const LogDensity& log_density, const Eigen::VectorXd& mean,
                                   const PerturbedSteps& steps, const GaussianProposal& proposal,
                                   const TemperedOptions& options) {
    const auto draws = static_cast<int>(steps.v.cols());
    const int N = options.particles;
    Eigen::MatrixXd mixed = Eigen::MatrixXd::Identity(draws, N);
    for (int i = 0; i < N && draws < N; ++i) {
        mixed.col(i) = RandomStream(options.seed, 1, i).normals(draws).normalized();
    }
    const Eigen::MatrixXd v = steps.v * mixed;
    const Eigen::RowVectorXd squares = v.cwiseProduct(steps.right_hand_sides * mixed).colwise().sum();
    TemperedResult result = unweighed((proposal.prior.coloured(v).colwise() + mean).transpose(),
                                      squares.transpose() / 2, log_density(mean), proposal);
    result.independent = draws;
    return result;
}

}  // namespace palpate::identify
