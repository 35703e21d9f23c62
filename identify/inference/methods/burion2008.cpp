#include "identify/inference/particles/burion2008.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/inference/methods/methods.h"
#include "identify/inference/particles/resampling.h"
#include "identify/inference/posterior.h"
#include "identify/loading/readings.h"
#include "identify/numerics/parallel.h"
#include "mesh/errors.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {
namespace {

/// Squared distances between measured and modelled markers. A body that does not stand counts as the worst that does.
Eigen::VectorXd squared_distances(const PositionDomain& domain, const Eigen::MatrixXd& particles, int threads) {
    Eigen::VectorXd e(particles.rows());
    for_each_in_parallel(static_cast<int>(e.size()), threads, [&](int i) {
        try {
            e[i] = domain.squared_distance(domain.predict(particles.row(i).transpose().array().log(), 1));
        } catch (const SolverFailure&) {
            e[i] = missing;
        }
    });
    double worst = -1;
    for (const double value : e) {
        if (!std::isnan(value)) worst = std::max(worst, value);
    }
    if (worst < 0) throw SolverFailure("no particle has an equilibrium under the measured loads: widen the search box");
    return e.unaryExpr([&](double value) { return std::isnan(value) ? worst : value; });
}

}  // namespace

IdentifyResult identify_burion2008(const skeleton::Model& model, const MeasurementSet& set,
                                   const IdentifyOptions& options, const Progress& progress) {
    const BurionOptions how{.particles = options.particles > 0 ? options.particles : default_burion_particles,
                            .iterations = options.iterations,
                            .search_low = options.search_low,
                            .search_high = options.search_high,
                            .seed = options.seed};
    const Parameters parameters = group_stiffness(model, options.scope, options.fixed);
    const skeleton::EquilibriumLaw law =
        options.law == LawChoice::linear ? skeleton::EquilibriumLaw::linear : skeleton::EquilibriumLaw::large_rotation;
    IdentifyResult result;
    BurionResult filter;
    if (options.domain == Domain::position) {
        const PositionDomain domain(model, law, parameters, informative_readings(model, set), options.threads);
        filter = burion2008(
            [&](const Eigen::MatrixXd& X) -> ParticleErrors {
                return {squared_distances(domain, X, options.threads), {}};
            },
            parameters.size(), how, progress);
        result.states = static_cast<int>(domain.states().size());
        result.coordinates = domain.coordinates();
        result.equilibria = how.particles * how.iterations * result.states;
    } else {
        const std::vector<MeasuredConfiguration> measured = complete_configurations(model, set, "method burion2008");
        const ForceDomain domain = force_domain(model, parameters, measured);
        filter = burion2008(
            [&](const Eigen::MatrixXd& X) -> ParticleErrors {
                return {squared_errors(domain.forces, X), squared_errors(domain.torques, X)};
            },
            parameters.size(), how, progress);
        result.states = static_cast<int>(measured.size());
        result.coordinates = domain.forces.rows + domain.torques.rows;
        result.notes.push_back(
            fmt::format("{} of {} states determine position and orientation of every sphere and were used",
                        measured.size(), set.states.size()));
    }

    const Eigen::VectorXd units = parameters.units();
    const Eigen::MatrixXd stiffness = filter.particles * units.asDiagonal();
    const StiffnessPrior prior = stiffness_prior(parameters, options.search_low, options.search_high);
    result.posterior = posterior_rows(parameters, stiffness, filter.log_weights, prior);
    result.correlations =
        strong_correlations(stiffness, filter.log_weights, prior.log_sd, effective_samples(filter.log_weights));
    result.best = filter.best.cwiseProduct(units);
    result.model = model;
    set_stiffness(result.model, parameters.stiffness(filter.mean.array().log()));
    result.model.law = law;
    for (FilterStep& step : filter.history) {
        step.particles = step.particles * units.asDiagonal();
        result.history.push_back(std::move(step));
    }
    result.notes.emplace_back("the spread of the particles is that of Algorithm 1's mutation, not of a posterior");
    return result;
}

}  // namespace palpate::identify
