#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "identify/inference/maximum/calibrate.h"
#include "identify/inference/maximum/left_out.h"
#include "identify/inference/methods/methods.h"
#include "identify/inference/particles/drawn.h"
#include "identify/inference/particles/tempered_filter.h"
#include "identify/inference/posterior.h"
#include "identify/loading/readings.h"
#include "identify/numerics/conjugate_gradients.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

constexpr double calibration_share = 0.4;  // of the progress
constexpr int pairs = 8, few_pairs = 2;    // of draws that find the particles' centre; where these are dear
constexpr int many_parameters = 100;       // the mode is far from the mean's neighbourhood, in more dimensions

/// Beyond so many sphere equilibria for one look at all particles, large rotations are stood in for.
constexpr double expensive_evaluations = 3e4;

/// Beyond so much work for one look at all particles by the linear law, they are not looked at one by one. A factor of
/// a body in space takes the square of its spheres.
constexpr double expensive_factors = 2e8;

bool is_too_expensive(const PositionDomain& domain, int particles) {
    const double spheres = domain.spheres();
    return domain.law() == skeleton::EquilibriumLaw::linear && particles * spheres * spheres > expensive_factors;
}

/// Whether one look at all particles by the full law costs too much; counted, not timed, so that it never changes.
bool is_expensive(const PositionDomain& domain, int particles) {
    return domain.law() == skeleton::EquilibriumLaw::large_rotation &&
           static_cast<double>(particles) * static_cast<double>(domain.states().size()) * domain.spheres() >
               expensive_evaluations;
}

std::vector<int> probes_of(const PositionDomain& domain, const MeasurementSet& set) {
    std::vector<int> probes;
    for (const StateReadings& state : domain.states()) probes.push_back(set.states[state.state].probe);
    return probes;
}

struct Sampled {
    TemperedResult filter;
    int evaluations = 0;    // of all equilibria
    std::string note = {};  // on what the particles are, where they are not weighed
};

/// Particles where a spectrum has no room for all that the measurements inform.
Sampled perturbed(const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
                  const LogDensity& log_density, const GaussianProposal& proposal, const TemperedOptions& how) {
    const ErrorJacobian jacobian =
        domain.jacobian(fit.theta, domain.predict(fit.theta, how.threads, &fit.prediction, true));
    const PerturbedSteps steps = perturbed_steps(
        jacobian, prior, fit.spectrum, independent_draws(domain.parameters().size(), how.particles), how.seed);
    Eigen::VectorXd mean = fit.theta;
    const SymmetricProduct A = whitened_curvature(jacobian, prior);
    const int evaluations = centre(
        mean, prior.coloured(steps.v.leftCols(few_pairs)), jacobian,
        [&](const Eigen::VectorXd& downhill) -> Eigen::VectorXd {
            return solve_shifted(A, 1, downhill, fit.spectrum, {.left = 1e-2}).X;
        },
        domain, prior, fit, how.threads);
    return {perturbed_particles(log_density, mean, steps, proposal, how), evaluations,
            "particles: the measurements inform too many directions to weigh them; they are fits to readings "
            "with other noise and a prior with another centre, by the slopes at the fit, and the evidence is rough"};
}

/// Particles from the fits' neighbourhoods to the posterior.
Sampled sample(const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
               const LogDensity& log_density, std::vector<GaussianProposal> proposals, const TemperedOptions& how,
               const Progress& progress) {
    if (!fit.spectrum.is_whole) return perturbed(domain, prior, fit, log_density, proposals.front(), how);
    const bool too_expensive = is_too_expensive(domain, how.particles);
    Sampled sampled;
    if (domain.parameters().size() > many_parameters) {
        sampled.evaluations =
            centre(proposals.front(), domain, prior, fit, too_expensive ? few_pairs : pairs, how.seed, how.threads);
    }
    if (too_expensive) {
        sampled.filter = laplace_particles(log_density, proposals.front(), how);
        sampled.note =
            "particles: the model is too large for importance weights; samples of the Laplace approximation, whose "
            "evidence is given";
        return sampled;
    }
    sampled.filter = tempered_filter(log_density, proposals, how, progress);
    if (!sampled.filter.weighed) {
        sampled.note =
            "particles: too many parameters for importance weights; samples of the Laplace approximation, moved "
            "towards the posterior by MCMC; Laplace evidence";
    }
    return sampled;
}

}  // namespace

IdentifyResult identify_tempered(const skeleton::Model& model, const MeasurementSet& set,
                                 const IdentifyOptions& options, const Progress& progress, const UniformFit* near) {
    // the most probable stiffness
    Calibration calibration = calibrate(
        model, informative_readings(model, set), options,
        [&](std::string_view what, double fraction) { report(progress, what, calibration_share * fraction); }, near);
    IdentifyResult result;
    result.notes = std::move(calibration.notes);
    const LogNormalPrior& prior = calibration.prior;
    result.forecast_error = leave_one_out_error(calibration.domain, prior, calibration.fit,
                                                probes_of(calibration.domain, set), options.threads);
    const Parameters& parameters = calibration.domain.parameters();

    // what the particles are weighed by
    const int particles = options.particles > 0 ? options.particles : default_particles;
    const bool expensive = is_expensive(calibration.domain, particles);
    if (expensive) {
        result.notes.emplace_back(
            "particles: large rotations enter as a correction found at the fit, as solving for each "
            "particle anew would take too long");
    }
    const PositionDomain domain = expensive
                                      ? calibration.domain.linearised(calibration.fit.theta, calibration.fit.prediction)
                                      : calibration.domain;
    const LogDensity log_density = [&](const Eigen::VectorXd& theta) {
        try {
            const Prediction prediction = domain.predict(theta, 1, &calibration.fit.prediction);
            return domain.log_constant() - 0.5 * domain.chi_squared(prediction) + prior.log_density(theta);
        } catch (const SolverFailure&) {
            return -std::numeric_limits<double>::infinity();  // such a body would not stand
        }
    };

    std::vector<GaussianProposal> proposals;
    std::vector<Eigen::VectorXd> mode_locations;
    const auto propose = [&](const FitResult& mode) {
        proposals.push_back(laplace_proposal(mode, prior));
        mode_locations.push_back(mode.theta);
    };
    propose(calibration.fit);
    std::ranges::for_each(calibration.others, propose);
    Sampled sampled = sample(domain, prior, calibration.fit, log_density, std::move(proposals),
                             {.particles = particles, .seed = options.seed, .threads = options.threads},
                             [&](std::string_view what, double fraction) {
                                 report(progress, what, calibration_share + (1 - calibration_share) * fraction);
                             });
    if (!sampled.note.empty()) result.notes.push_back(std::move(sampled.note));

    report_particles(parameters, prior, mode_locations, sampled.filter, result);
    if (result.modes.size() > 1) {
        result.notes.push_back(
            fmt::format("the posterior has {} modes, of which the model holds the most probable one; the particles "
                        "give their probabilities",
                        result.modes.size()));
    }
    if (!std::isnan(result.forecast_error.relative)) {
        result.notes.push_back(fmt::format("a probe that is held out of the fit is off by {}{}",
                                           calibration.fit.spectrum.is_whole ? "" : "at least ",
                                           mesh::share_of(result.forecast_error.relative, "its displacement")));
    }
    result.fit_trace = calibration.fit.trace;
    result.model_error = calibration.model_error;
    result.states = static_cast<int>(domain.states().size());
    result.coordinates = domain.coordinates();
    result.model = calibrated(model, calibration);
    result.equilibria = calibration.equilibria + (sampled.evaluations + sampled.filter.evaluations) * result.states;
    return result;
}

}  // namespace palpate::identify
