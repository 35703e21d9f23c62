#include "identify/inference/methods/full_law.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/inference/particles/resampling.h"
#include "identify/numerics/parallel.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// Where the equilibria under a particle's stiffness lie nearly: those of the fit, moved as the linear law says, and
/// that law's tangent.
Prediction start_of(const Prediction& linear, const Prediction& linear_at_fit, const Prediction& at_fit) {
    Prediction start{at_fit.equilibria, {}, {}, at_fit.unmeasured};
    for (std::size_t s = 0; s < start.equilibria.size(); ++s) {
        start.equilibria[s].state =
            skeleton::advance(start.equilibria[s].state, linear.equilibria[s].step - linear_at_fit.equilibria[s].step);
    }
    start.tangents.assign(start.equilibria.size(), linear.tangents.front());
    return start;
}

}  // namespace

double weigh_by_full_law(TemperedResult& particles, const PositionDomain& domain, const PositionDomain& surrogate,
                         const FitResult& fit, int threads) {
    const auto N = static_cast<int>(particles.particles.rows());
    const Prediction linear_at_fit = surrogate.predict(fit.theta, 1);
    Eigen::VectorXd log_ratio(N);
    for_each_in_parallel(N, threads, [&](int i) {
        log_ratio[i] = -std::numeric_limits<double>::infinity();
        if (!std::isfinite(particles.log_density[i])) return;
        try {
            const Eigen::VectorXd theta = particles.particles.row(i);
            const Prediction linear = surrogate.predict(theta, 1);
            const Prediction start = start_of(linear, linear_at_fit, fit.prediction);
            log_ratio[i] = (surrogate.chi_squared(linear) - domain.chi_squared(domain.predict(theta, 1, &start))) / 2;
        } catch (const SolverFailure&) {  // such a body would not stand
        }
    });

    const double before = effective_samples(particles.log_weights);
    particles.log_density += log_ratio;
    particles.log_weights += log_ratio;
    particles.log_evidence += normalise(particles.log_weights);
    const double share = effective_samples(particles.log_weights) / before;
    // the mean of weights whose squares add up to 1 / (N share) has a relative variance of (1 / share - 1) /
    // independent
    const double independent = particles.independent > 0 ? particles.independent : before;
    const double of_ratio = std::max(0.0, 1 / share - 1) / independent;
    if (!std::isnan(particles.log_evidence_sd)) {
        particles.log_evidence_sd = std::sqrt(std::pow(particles.log_evidence_sd, 2) + of_ratio);
    }
    if (particles.independent > 0) particles.independent = std::max(1, static_cast<int>(share * independent));
    particles.history.back().log_weights = particles.log_weights;
    particles.history.back().effective_samples = particles.independent > 0 ? particles.independent : share * before;
    particles.evaluations += N;
    return share;
}

}  // namespace palpate::identify
