#include "identify/identify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/fit/calibrate.h"
#include "identify/fit/node_configuration.h"
#include "identify/particles/burion2008.h"
#include "identify/particles/posterior.h"
#include "identify/particles/tempered_filter.h"
#include "identify/set/field.h"
#include "mesh/errors.h"
#include "skeleton/statics.h"

namespace palpate::identify {
namespace {

constexpr int default_particles = 200, default_burion_particles = 600;
constexpr double calibration_share = 0.4;  // of the progress
constexpr int many_parameters = 100;       // the mode is far from the mean's neighbourhood, in more dimensions

/// Beyond so many sphere equilibria for one look at all particles, large rotations are stood in for.
constexpr double dear_evaluations = 3e4;

void note_left_out(const MeasurementSet& set, IdentifyResult& result) {
    int unlabelled = 0;
    for (const LoadState& state : set.states) {
        unlabelled += static_cast<int>(std::ranges::count(state.readings, -1, &Reading::marker));
    }
    if (unlabelled > 0) result.notes.push_back(fmt::format("{} unlabelled readings were left out", unlabelled));
}

/// Whether one look at all particles by the full law costs too much; counted, not timed, so that it never changes.
bool is_dear(const PositionDomain& domain, const skeleton::Model& model, int particles) {
    return domain.law() == skeleton::Law::large_rotation &&
           static_cast<double>(particles) * static_cast<double>(domain.states().size() * model.spheres.size()) >
               dear_evaluations;
}

IdentifyResult identify_tempered(const skeleton::Model& model, const MeasurementSet& set,
                                 const IdentifyOptions& options, const Progress& progress, const UniformFit* near) {
    const std::vector<StateReadings> readings = collect_readings(model, set);
    if (std::ranges::none_of(readings, &StateReadings::tells_stiffness)) {
        throw InvalidInput(
            fmt::format("measurement set '{}' has no state with both a load and a labelled reading: stiffness "
                        "shows only under a force or a known gravity; add a row with a force to "
                        "probes.csv and its markers to positions.csv",
                        set.name));
    }

    // the most probable stiffness
    Calibration calibration = calibrate(
        model, readings, options,
        [&](std::string_view what, double fraction) { report(progress, what, calibration_share * fraction); }, near);
    IdentifyResult result;
    result.notes = std::move(calibration.notes);
    const LogNormalPrior& prior = calibration.prior;
    const Parameters& parameters = calibration.domain.parameters();

    // what the particles are weighed by
    const int particles = options.particles > 0 ? options.particles : default_particles;
    const bool dear = is_dear(calibration.domain, model, particles);
    if (dear) {
        result.notes.emplace_back(
            "particles: large rotations enter as a correction found at the fit, as solving for each "
            "particle anew would take too long");
    }
    const PositionDomain domain =
        dear ? calibration.domain.linearised(calibration.fit.theta, calibration.fit.prediction) : calibration.domain;
    const LogDensity log_density = [&](const Eigen::VectorXd& theta) {
        try {
            const Prediction prediction = domain.predict(theta, 1, &calibration.fit.prediction);
            return domain.log_constant() - 0.5 * domain.chi_squared(prediction) + prior.log_density(theta);
        } catch (const SolverFailure&) {
            return -std::numeric_limits<double>::infinity();  // such a body would not stand
        }
    };

    // particles from the fit's neighbourhood to the posterior
    GaussianProposal proposal = laplace_proposal(calibration.fit, prior);
    int centring = 0;  // times that all equilibria were solved
    if (parameters.size() > many_parameters) {
        centring = centre(proposal, domain, prior, calibration.fit.prediction, options.seed, options.threads);
    }
    TemperedOptions filter_options{.particles = particles, .seed = options.seed, .threads = options.threads};
    TemperedResult filter =
        tempered_filter(log_density, proposal, filter_options, [&](std::string_view what, double fraction) {
            report(progress, what, calibration_share + (1 - calibration_share) * fraction);
        });

    if (!filter.weighed) {
        result.notes.emplace_back(
            "particles: too many parameters to weigh them; they are drawn from the fit's own "
            "covariance and moved towards the posterior, and the evidence is Laplace's");
    }
    const Eigen::MatrixXd stiffness = stiffness_of(parameters, filter.particles);
    result.posterior = posterior_rows(parameters, stiffness, filter.log_weights, stiffness_prior(parameters, prior));
    Eigen::Index best = 0;
    filter.log_density.maxCoeff(&best);
    result.best = stiffness.row(best);
    result.model = calibrated(model, calibration);
    for (FilterStep& step : filter.history) {
        step.particles = stiffness_of(parameters, step.particles);
        result.history.push_back(std::move(step));
    }
    result.log_evidence = filter.log_evidence;
    result.acceptance = filter.acceptance;
    result.equilibria =
        calibration.equilibria + (centring + filter.evaluations) * static_cast<int>(domain.states().size());
    return result;
}

IdentifyResult identify_burion2008(const skeleton::Model& model, const MeasurementSet& set,
                                   const IdentifyOptions& options, const Progress& progress) {
    const std::vector<MeasuredConfiguration> measured = measured_configurations(model, set);
    if (measured.empty()) {
        throw InvalidInput(fmt::format(
            "measurement set '{}' has no loaded state in which every sphere's place and turn are known, which method "
            "burion2008 needs: at least three markers on each sphere, not in line, or the full field; "
            "method tempered does without",
            set.name));
    }
    const Parameters parameters = group_stiffness(model, options.scope, options.fixed);
    const ForceDomain domain = force_domain(model, parameters, measured);

    const BurionOptions filter_options{
        .particles = options.particles > 0 ? options.particles : default_burion_particles,
        .iterations = options.iterations,
        .search_low = options.search_low,
        .search_high = options.search_high,
        .seed = options.seed};
    const MeasurementModel errors_of = [&](const Eigen::MatrixXd& X) -> ParticleErrors {
        return {squared_errors(domain.forces, X), squared_errors(domain.torques, X)};
    };
    BurionResult filter = burion2008(errors_of, parameters.size(), filter_options, progress);

    IdentifyResult result;
    const Eigen::VectorXd units = parameters.units();
    result.posterior = posterior_rows(parameters, filter.particles * units.asDiagonal(), filter.log_weights,
                                      stiffness_prior(parameters, options.search_low, options.search_high));
    result.best = filter.best.cwiseProduct(units);
    result.model = model;
    set_stiffness(result.model, parameters.stiffness(filter.mean.array().log()));
    result.model.law = options.law == LawChoice::linear ? skeleton::Law::linear : skeleton::Law::large_rotation;
    for (FilterStep& step : filter.history) {
        step.particles = step.particles * units.asDiagonal();
        result.history.push_back(std::move(step));
    }
    result.notes.push_back(fmt::format("{} of {} states tell every sphere's place and turn and were used",
                                       measured.size(), set.states.size()));
    result.notes.emplace_back("the spread of the particles is that of Algorithm 1's mutation, not of a posterior");
    return result;
}

}  // namespace

void IdentifyOptions::validate() const {
    const auto demand = [](bool holds, const char* option, double value, const char* allowed) {
        if (!holds) throw InvalidInput(fmt::format("option {} is {}; it must be {}", option, value, allowed));
    };
    demand(particles == 0 || particles >= 10, "particles", particles, "0 (by the method) or at least 10");
    demand(iterations >= 1, "iterations", iterations, "at least 1");
    demand(search_low > 0, "search_low", search_low, "above 0");
    demand(search_high > search_low, "search_high", search_high, "above search_low");
    demand(threads >= 1, "threads", threads, "at least 1");
}

IdentifyResult identify(const skeleton::Model& model, const MeasurementSet& set, const IdentifyOptions& options,
                        const Progress& progress, const UniformFit* near) {
    options.validate();
    const MeasurementSet readable = with_markers_of_fields(set);
    IdentifyResult result = options.method == Method::burion2008
                                ? identify_burion2008(model, readable, options, progress)
                                : identify_tempered(model, readable, options, progress, near);
    note_left_out(set, result);
    return result;
}

}  // namespace palpate::identify
