#include "identify/particles/drawn.h"

#include <cmath>

#include "identify/particles/random.h"

namespace palpate::identify {

TemperedResult drawn_particles(const LogDensity& log_density, const GaussianProposal& proposal,
                               const TemperedOptions& options) {
    const auto P = static_cast<int>(proposal.mean.size());
    const int N = options.particles;
    Eigen::MatrixXd z(P, N);
    for (int i = 0; i < N; ++i) z.col(i) = RandomStream(options.seed, 0, i).normals(P);

    TemperedResult result;
    result.particles = proposal.parameters(z).transpose();
    result.log_weights = Eigen::VectorXd::Constant(N, -std::log(N));
    const double at_mean = log_density(proposal.mean);
    result.log_evidence = at_mean - proposal.log_peak();
    result.log_density = at_mean - z.colwise().squaredNorm().transpose().array() / 2;
    result.mode.assign(static_cast<std::size_t>(N), 0);
    result.weighed = false;
    result.evaluations = 1;
    result.history.push_back({1, static_cast<double>(N), result.particles, result.log_weights});
    return result;
}

}  // namespace palpate::identify
