#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "identify/fit/calibrate.h"
#include "identify/fit/conjugate_gradients.h"
#include "identify/fit/left_out.h"
#include "identify/methods/methods.h"
#include "identify/particles/drawn.h"
#include "identify/particles/posterior.h"
#include "identify/particles/tempered_filter.h"
#include "identify/set/readings.h"
#include "mesh/errors.h"
#include "mesh/io/words.h"

namespace palpate::identify {
namespace {

constexpr double calibration_share = 0.4;  // of the progress
constexpr int pairs = 8, few_pairs = 2;    // of draws that find the particles' centre; where these are dear
constexpr int many_parameters = 100;       // the mode is far from the mean's neighbourhood, in more dimensions

/// Beyond so many sphere equilibria for one look at all particles, large rotations are stood in for.
constexpr double dear_evaluations = 3e4;

/// Beyond so much work for one look at all particles by the linear law, they are not looked at one by one. A factor of
/// a body in space takes the square of its spheres.
constexpr double dear_factors = 2e8;

bool is_too_dear(const PositionDomain& domain, int particles) {
    const double spheres = domain.spheres();
    return domain.law() == skeleton::Law::linear && particles * spheres * spheres > dear_factors;
}

/// Whether one look at all particles by the full law costs too much; counted, not timed, so that it never changes.
bool is_dear(const PositionDomain& domain, int particles) {
    return domain.law() == skeleton::Law::large_rotation &&
           static_cast<double>(particles) * static_cast<double>(domain.states().size()) * domain.spheres() >
               dear_evaluations;
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

/// Particles where a spectrum has no room for all that the measurements tell of.
Sampled perturbed(const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
                  const LogDensity& log_density, const GaussianProposal& proposal, const TemperedOptions& how) {
    const Slopes slopes = domain.slopes(fit.theta, domain.predict(fit.theta, how.threads, &fit.prediction, true));
    const PerturbedSteps steps = perturbed_steps(
        slopes, prior, fit.spectrum, independent_draws(domain.parameters().size(), how.particles), how.seed);
    Eigen::VectorXd mean = fit.theta;
    const SymmetricProduct A = whitened_curvature(slopes, prior);
    const int evaluations = centre(
        mean, prior.coloured(steps.v.leftCols(few_pairs)), slopes,
        [&](const Eigen::VectorXd& downhill) -> Eigen::VectorXd {
            return solve_shifted(A, 1, downhill, fit.spectrum, {.left = 1e-2}).X;
        },
        domain, prior, fit, how.threads);
    return {perturbed_particles(log_density, mean, steps, proposal, how), evaluations,
            "particles: too many directions that the measurements tell of to weigh them; they are fits to readings "
            "with other noise and a prior with another centre, by the slopes at the fit, and the evidence is rough"};
}

/// Particles from the fits' neighbourhoods to the posterior.
Sampled sample(const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
               const LogDensity& log_density, std::vector<GaussianProposal> proposals, const TemperedOptions& how,
               const Progress& progress) {
    if (!fit.spectrum.is_whole) return perturbed(domain, prior, fit, log_density, proposals.front(), how);
    const bool too_dear = is_too_dear(domain, how.particles);
    Sampled sampled;
    if (domain.parameters().size() > many_parameters) {
        sampled.evaluations =
            centre(proposals.front(), domain, prior, fit, too_dear ? few_pairs : pairs, how.seed, how.threads);
    }
    if (too_dear) {
        sampled.filter = drawn_particles(log_density, proposals.front(), how);
        sampled.note =
            "particles: too large a body to weigh them; they are drawn from the fit's own covariance, and the "
            "evidence is Laplace's";
        return sampled;
    }
    sampled.filter = tempered_filter(log_density, proposals, how, progress);
    if (!sampled.filter.weighed) {
        sampled.note =
            "particles: too many parameters to weigh them; they are drawn from the fit's own covariance and moved "
            "towards the posterior, and the evidence is Laplace's";
    }
    return sampled;
}

}  // namespace

IdentifyResult identify_tempered(const skeleton::Model& model, const MeasurementSet& set,
                                 const IdentifyOptions& options, const Progress& progress, const UniformFit* near) {
    // the most probable stiffness
    Calibration calibration = calibrate(
        model, telling_readings(model, set), options,
        [&](std::string_view what, double fraction) { report(progress, what, calibration_share * fraction); }, near);
    IdentifyResult result;
    result.notes = std::move(calibration.notes);
    const LogNormalPrior& prior = calibration.prior;
    result.forecast_error =
        left_out_error(calibration.domain, prior, calibration.fit, probes_of(calibration.domain, set), options.threads);
    const Parameters& parameters = calibration.domain.parameters();

    // what the particles are weighed by
    const int particles = options.particles > 0 ? options.particles : default_particles;
    const bool dear = is_dear(calibration.domain, particles);
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

    std::vector<GaussianProposal> proposals;
    std::vector<Eigen::VectorXd> tops;
    const auto propose = [&](const FitResult& mode) {
        proposals.push_back(laplace_proposal(mode, prior));
        tops.push_back(mode.theta);
    };
    propose(calibration.fit);
    std::ranges::for_each(calibration.others, propose);
    Sampled sampled = sample(domain, prior, calibration.fit, log_density, std::move(proposals),
                             {.particles = particles, .seed = options.seed, .threads = options.threads},
                             [&](std::string_view what, double fraction) {
                                 report(progress, what, calibration_share + (1 - calibration_share) * fraction);
                             });
    if (!sampled.note.empty()) result.notes.push_back(std::move(sampled.note));

    tell_particles(parameters, prior, tops, sampled.filter, result);
    if (result.modes.size() > 1) {
        result.notes.push_back(fmt::format(
            "{} different stiffnesses explain the measurements, of which the model holds one: the particles "
            "tell how probable each is",
            result.modes.size()));
    }
    if (!std::isnan(result.forecast_error.relative)) {
        result.notes.push_back(fmt::format("a probe that is left out of the fit: off by {}{}",
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
