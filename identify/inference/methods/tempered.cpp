#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "identify/inference/maximum/calibrate.h"
#include "identify/inference/maximum/left_out.h"
#include "identify/inference/methods/full_law.h"
#include "identify/inference/methods/methods.h"
#include "identify/inference/particles/drawn.h"
#include "identify/inference/particles/hamiltonian/convergence.h"
#include "identify/inference/particles/hamiltonian/hamiltonian_filter.h"
#include "identify/inference/particles/tempered_filter.h"
#include "identify/inference/posterior.h"
#include "identify/loading/readings.h"
#include "identify/numerics/conjugate_gradients.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

constexpr double calibration_share = 0.4;  // of the progress
constexpr int pairs = 8, few_pairs = 2;    // of draws that find the particles' centre; where these are expensive
constexpr int many_parameters = 100;       // the mode is far from the mean's neighbourhood, in more dimensions
constexpr double hardly_any_weigh = 0.1;   // of the particles, where the surrogate is not the law

/// Beyond so many sphere equilibria for one evaluation of all particles, they move by a surrogate for large rotations,
/// and are weighed by these in the end.
constexpr double expensive_evaluations = 3e4;

/// Beyond so much work for one evaluation of all particles by the linear law, they are not evaluated one by one. A
/// factor of a body in space takes the square of its spheres.
constexpr double expensive_factors = 2e8;

/// Work [flop] of chains that is affordable: ten seconds of one core at 25 Gflop/s, as dense factors of an organ ran.
constexpr double affordable_work = 2.5e11;
constexpr int evaluations_per_particle = 15;  // of the density, annealing included: 11 on lattices, 20 on an organ

bool is_too_expensive(const PositionDomain& domain, int particles) {
    const double spheres = domain.spheres();
    return particles * spheres * spheres > expensive_factors;
}

/// Evaluations of the density with its gradient that are affordable. By adjoints one takes a dense factor of n unknowns
/// and two solutions for each state, otherwise some four factors for each state. The work of small models is not in
/// their factors, so that there are bounds besides.
int affordable_evaluations(const PositionDomain& domain) {
    const double n = 6.0 * domain.spheres(), states = static_cast<double>(domain.states().size());
    if (domain.has_adjoint_gradient()) {
        return static_cast<int>(std::min(20000.0, affordable_work / (n * n * n / 3 + 4 * n * n * states)));
    }
    return static_cast<int>(std::min(3000.0, affordable_work / (4 * states * n * n * n / 3)));
}

/// Do chains come to as many particles within the affordable work?
bool can_sample_by_gradients(const PositionDomain& domain, int particles) {
    return particles * evaluations_per_particle <= affordable_evaluations(domain);
}

/// Is an equilibrium of each particle in each state by the full law affordable? Some three dense factors each.
bool can_weigh_by_full_law(const PositionDomain& domain, int particles) {
    const double n = 6.0 * domain.spheres(), states = static_cast<double>(domain.states().size());
    return particles * states * n * n * n <= affordable_work;
}

double sphere_equilibria(const PositionDomain& domain) {
    return static_cast<double>(domain.states().size()) * domain.spheres();
}

/// Whether one evaluation of all particles by the full law costs too much; counted, not timed, so that it never
/// changes.
bool is_expensive(const PositionDomain& domain, int particles) {
    return domain.law() == skeleton::EquilibriumLaw::large_rotation &&
           particles * sphere_equilibria(domain) > expensive_evaluations;
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

/// What particles are evaluated by.
struct Target {
    const PositionDomain& domain;     // the law itself
    const PositionDomain& surrogate;  // what they move by: the same, or the linear law corrected at the fit
    const LogNormalPrior& prior;
    const FitResult& fit;

    bool is_corrected() const { return &domain != &surrogate; }
    double log_density(const Eigen::VectorXd& theta) const {
        try {
            const Prediction prediction = surrogate.predict(theta, 1, &fit.prediction);
            return surrogate.log_constant() - 0.5 * surrogate.chi_squared(prediction) + prior.log_density(theta);
        } catch (const SolverFailure&) {
            return -std::numeric_limits<double>::infinity();  // such a body would not stand
        }
    }
    double log_density(const Eigen::VectorXd& theta, Eigen::VectorXd& gradient) const {
        try {
            const double half = surrogate.half_chi_squared(theta, gradient, &fit.prediction);
            gradient = -gradient - prior.precision_times(theta - prior.mean);
            return surrogate.log_constant() - half + prior.log_density(theta);
        } catch (const SolverFailure&) {
            return -std::numeric_limits<double>::infinity();
        }
    }
};

/// Particles where the model is so large that they are not evaluated one by one, and a spectrum has no room for all
/// that the measurements inform.
Sampled perturbed(const Target& target, const LogDensity& log_density, const GaussianProposal& proposal,
                  const TemperedOptions& how) {
    const auto& [domain, surrogate, prior, fit] = target;
    const ErrorJacobian jacobian =
        surrogate.jacobian(fit.theta, surrogate.predict(fit.theta, how.threads, &fit.prediction, true));
    const PerturbedSteps steps = perturbed_steps(
        jacobian, prior, fit.spectrum, independent_draws(domain.parameters().size(), how.particles), how.seed);
    Eigen::VectorXd mean = fit.theta;
    const SymmetricProduct A = whitened_curvature(jacobian, prior);
    const int evaluations = centre(
        mean, prior.coloured(steps.v.leftCols(few_pairs)), jacobian,
        [&spectrum = fit.spectrum, &A](const Eigen::VectorXd& downhill) -> Eigen::VectorXd {
            return solve_shifted(A, 1, downhill, spectrum, {.left = 1e-2}).X;
        },
        surrogate, prior, fit, how.threads);
    return {perturbed_particles(log_density, mean, steps, proposal, how), evaluations,
            "particles: draws of the posterior would take too long for a model of this size; they are fits to readings "
            "with other noise and a prior with another centre, by the slopes at the fit, and the evidence is rough"};
}

/// Particles by Hamiltonian Monte Carlo; none where that takes too long.
std::optional<TemperedResult> sampled_by_gradients(const Target& target, const GaussianProposal& proposal,
                                                   const TemperedOptions& how, const Progress& progress) {
    if (!can_sample_by_gradients(target.surrogate, how.particles)) return std::nullopt;
    try {
        return hamiltonian_filter([&](const Eigen::VectorXd& theta,
                                      Eigen::VectorXd& gradient) { return target.log_density(theta, gradient); },
                                  proposal,
                                  {.particles = how.particles,
                                   .evaluations = affordable_evaluations(target.surrogate),
                                   .seed = how.seed,
                                   .threads = how.threads},
                                  progress);
    } catch (const SolverFailure&) {
        return std::nullopt;
    }
}

/// Particles from the fits' neighbourhoods to the posterior, by the surrogate.
Sampled sample_surrogate(const Target& target, std::vector<GaussianProposal> proposals, const TemperedOptions& how,
                         const Progress& progress) {
    const LogDensity log_density = [&](const Eigen::VectorXd& theta) { return target.log_density(theta); };
    const auto& [domain, surrogate, prior, fit] = target;
    const bool too_expensive = is_too_expensive(domain, how.particles);
    if (!fit.spectrum.is_whole && !can_sample_by_gradients(surrogate, how.particles)) {
        return perturbed(target, log_density, proposals.front(), how);
    }
    const bool has_many = domain.parameters().size() > many_parameters;
    Sampled sampled;
    if (has_many) {
        sampled.evaluations =
            centre(proposals.front(), surrogate, prior, fit, too_expensive ? few_pairs : pairs, how.seed, how.threads);
    }
    if (too_expensive) {
        sampled.filter = laplace_particles(log_density, proposals.front(), how);
        sampled.note =
            "particles: the model is too large for importance weights; samples of the Laplace approximation, whose "
            "evidence is given";
        return sampled;
    }

    // draws that can be weighed at once, or else moves: of a few numbers without gradients, from every mode
    const bool has_chains = has_many && can_sample_by_gradients(surrogate, how.particles);
    if (fit.spectrum.is_whole) {
        TemperedOptions weighed = how;
        weighed.at_once = has_chains;
        sampled.filter = tempered_filter(log_density, proposals, weighed, progress);
        if (sampled.filter.weighed) return sampled;
        sampled.evaluations += sampled.filter.evaluations;
    }
    if (std::optional<TemperedResult> found = sampled_by_gradients(target, proposals.front(), how, progress)) {
        sampled.filter = std::move(*found);
        if (sampled.filter.r_hat > good_r_hat) {
            sampled.note = fmt::format(
                "particles: two independent clouds of chains do not agree yet (R-hat {:.2f}, {:g} is good), and the "
                "model is too large to continue them; more of them (--particles) may agree",
                sampled.filter.r_hat, good_r_hat);
        }
        return sampled;
    }
    const bool is_moved = fit.spectrum.is_whole && !has_chains;
    if (!is_moved) sampled.filter = laplace_particles(log_density, proposals.front(), how);
    sampled.note = !is_moved
                       ? "particles: draws of the posterior are out of reach, as it bends too much for chains to move "
                         "through; samples of the Laplace approximation, whose evidence is given"
                       : "particles: too many parameters for importance weights; samples of the Laplace approximation, "
                         "moved towards the posterior by MCMC; Laplace evidence";
    return sampled;
}

/// The same, weighed by the law itself.
Sampled sample(const Target& target, std::vector<GaussianProposal> proposals, const TemperedOptions& how,
               const Progress& progress) {
    Sampled sampled = sample_surrogate(target, std::move(proposals), how, progress);
    if (!target.is_corrected()) return sampled;
    const auto say = [&](const std::string& more) { sampled.note += (sampled.note.empty() ? "" : ". ") + more; };
    if (!sampled.filter.weighed ||
        !can_weigh_by_full_law(target.domain, static_cast<int>(sampled.filter.particles.rows()))) {
        say("particles: large rotations enter as a correction found at the fit, as solving for each particle anew "
            "would take too long");
        return sampled;
    }
    const double share = weigh_by_full_law(sampled.filter, target.domain, target.surrogate, target.fit, how.threads);
    if (share < hardly_any_weigh) {
        say(fmt::format(
            "particles: large rotations weigh only {:.0f} % of them, which moved by the linear law corrected at the "
            "fit: more of them (--particles) tell more",
            100 * share));
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
    const std::optional<PositionDomain> surrogate =
        is_expensive(calibration.domain, particles)
            ? std::optional(calibration.domain.linearised(calibration.fit.theta, calibration.fit.prediction))
            : std::nullopt;
    const Target target{calibration.domain, surrogate ? *surrogate : calibration.domain, prior, calibration.fit};

    std::vector<GaussianProposal> proposals;
    std::vector<Eigen::VectorXd> mode_locations;
    const auto propose = [&](const FitResult& mode) {
        proposals.push_back(laplace_proposal(mode, prior));
        mode_locations.push_back(mode.theta);
    };
    propose(calibration.fit);
    std::ranges::for_each(calibration.others, propose);
    Sampled sampled =
        sample(target, std::move(proposals), {.particles = particles, .seed = options.seed, .threads = options.threads},
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
        result.notes.push_back(fmt::format("prediction error on held-out probes, beyond the noise: {}{}",
                                           calibration.fit.spectrum.is_whole ? "" : "at least ",
                                           mesh::share_of(result.forecast_error.relative, "its displacement")));
    }
    result.fit_trace = calibration.fit.trace;
    result.model_error = calibration.model_error;
    result.states = static_cast<int>(calibration.domain.states().size());
    result.coordinates = calibration.domain.coordinates();
    result.model = calibrated(model, calibration);
    result.equilibria = calibration.equilibria + (sampled.evaluations + sampled.filter.evaluations) * result.states;
    return result;
}

}  // namespace palpate::identify
