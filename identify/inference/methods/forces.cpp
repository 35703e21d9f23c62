#include <fmt/format.h>

#include <cmath>

#include "identify/inference/maximum/force_fit.h"
#include "identify/inference/methods/methods.h"
#include "identify/inference/particles/tempered_filter.h"
#include "identify/inference/posterior.h"
#include "identify/inference/problem/inform.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {
namespace {

constexpr double least_multiplier = 1e-3;  // that the exact solution starts the fit with

/// ln of the exact solution, where it is above zero.
Eigen::VectorXd log_solution(const ForceStatistics& statistics) {
    return solve_force_domain(statistics).array().max(least_multiplier).log();
}

}  // namespace

IdentifyResult identify_by_forces(const skeleton::Model& model, const MeasurementSet& set,
                                  const IdentifyOptions& options, const Progress& progress) {
    const std::vector<MeasuredConfiguration> measured = complete_configurations(model, set, "the force domain");
    const auto statistics_of = [&](const Parameters& parameters) {
        const ForceDomain domain = force_domain(model, parameters, measured);
        return domain.forces + domain.torques;
    };

    // one multiplier a kind first: what is believed of the finer ones
    const Parameters uniform = group_stiffness(model, Scope::uniform, options.fixed),
                     parameters = group_stiffness(model, options.scope, options.fixed);
    const Eigen::VectorXd coarse = log_solution(statistics_of(uniform));
    ForcePosterior posterior{statistics_of(parameters), {spread_kinds(parameters, uniform, coarse), {}, nullptr}, 1};
    const bool single = options.scope == Scope::links;
    posterior.prior.sd = Eigen::VectorXd::Constant(parameters.size(), single ? link_sd : wide_sd);
    if (single) posterior.prior.field = smoothness_field(model, parameters);
    inform(posterior.prior, parameters, options.priors);

    // the exact solution tells the noise, the fit what is most probable
    const Eigen::VectorXd exact = solve_force_domain(posterior.statistics);
    posterior.sigma = force_noise(posterior.statistics, exact);
    const ForceFit fit = fit_forces(posterior, exact.array().max(least_multiplier).log());
    const GaussianProposal proposal{fit.theta,
                                    {fit.theta, Eigen::VectorXd::Ones(parameters.size()), fit.spread},
                                    {},
                                    1 + 1 / static_cast<double>(parameters.size())};
    const TemperedOptions how{.particles = options.particles > 0 ? options.particles : default_particles,
                              .seed = options.seed,
                              .threads = options.threads};
    TemperedResult filter = tempered_filter([&](const Eigen::VectorXd& theta) { return posterior.log_density(theta); },
                                            {proposal}, how, progress);

    IdentifyResult result;
    result.model = model;
    set_stiffness(result.model, parameters.stiffness(fit.theta));
    result.model.law =
        options.law == LawChoice::linear ? skeleton::EquilibriumLaw::linear : skeleton::EquilibriumLaw::large_rotation;
    report_particles(parameters, posterior.prior, {fit.theta}, filter, result);
    result.fit_trace = fit.trace;
    result.states = static_cast<int>(measured.size());
    result.coordinates = posterior.statistics.rows;
    result.notes.push_back(fmt::format("{} of {} states tell every sphere's place and turn and were used",
                                       measured.size(), set.states.size()));
    result.notes.push_back(fmt::format(
        "net forces are off by {:.3g} N; noise in the positions makes them so, and biases stiffness: compare with the "
        "position domain",
        posterior.sigma));
    return result;
}

}  // namespace palpate::identify
