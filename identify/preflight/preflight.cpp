#include "identify/preflight/preflight.h"

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/search/baselines.h"
#include "identify/diagnosis/statistics/independent_readings.h"
#include "identify/diagnosis/statistics/outliers/exchanged_markers.h"
#include "identify/effects/catalogue.h"
#include "identify/measurements/rig/fittable.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// Stiffness as the set says, unless a body of it answers far otherwise than was read; else scaled to the readings.
Explanation guess_of(const BodyModel& model, const MeasurementSet& set, const Problem& problem, int law, int threads,
                     bool& is_sets) {
    Explanation scaled = first_guess(model, problem, law, threads);
    is_sets = set.material && set.material->young > 0;
    if (!is_sets) return scaled;
    Explanation told = scaled;
    for (Eigen::Index p = 0; p < told.theta.size(); ++p)
        told.theta[p] = model.parameters()[static_cast<std::size_t>(p)].start;
    constexpr double far = 3;  // times as stiff: what effects that are missing, and large deformation, hardly make
    is_sets = std::abs(std::log(model.young(told.setting()) / model.young(scaled.setting()))) < std::log(far);
    return is_sets ? told : scaled;
}

/// Of the laws of large deformation the last is the best behaved. Where a load has no equilibrium under it the guess is
/// too soft: it is made stiffer, in steps; where that does not help, small strain has one.
LinearPoint point_of(const BodyModel& model, const MeasurementSet& set, const Problem& problem,
                     const DiagnoseOptions& options, bool& is_sets) {
    const int threads = options.refit.threads;
    const int last = static_cast<int>(model.laws().size()) - 1;
    Explanation guess = guess_of(model, set, problem, last, threads, is_sets);
    constexpr int attempts = 4;  // up to e^0.9 = 2.5 times as stiff
    for (int attempt = 0; attempt < attempts && last > 0; ++attempt) {
        try {
            return linearise(model, problem, guess, options.mesh_error, threads);
        } catch (const SolverFailure&) {
            is_sets = false;
            for (Eigen::Index p = 0; p < guess.theta.size(); ++p)
                if (model.parameters()[static_cast<std::size_t>(p)].stiffens) guess.theta[p] += 0.3;
        }
    }
    return linearise(model, problem, guess_of(model, set, problem, 0, threads, is_sets), options.mesh_error, threads);
}

std::vector<Suspicion> exchanged_markers(const Problem& problem, const Whitening& V, const Eigen::VectorXd& d) {
    std::vector<Suspicion> result;
    for (const ExchangedMarkers& one : find_exchanged_markers(problem, V, d)) {
        const double apart = (problem.rest.row(one.markers.first) - problem.rest.row(one.markers.second)).norm();
        result.push_back({Suspect::exchanged, one.state, one.markers.first, one.markers.second, apart, 0});
    }
    return result;
}

/// A reading whose name is wrong is no other suspicion.
bool is_told_by(const std::vector<Suspicion>& exchanged, const Suspicion& one) {
    return std::ranges::any_of(exchanged, [&](const Suspicion& pair) {
        return pair.state == one.state && (pair.marker == one.marker || pair.other == one.marker);
    });
}

}  // namespace

const EffectProspect* Preflight::prospect_of(const std::string& name) const {
    const auto found = std::ranges::find_if(effects, [&](const auto& one) { return one.effect->name() == name; });
    return found == effects.end() ? nullptr : &*found;
}

Preflight assess(const BodyModel& model, const MeasurementSet& set, const PreflightOptions& options,
                 const Progress& progress) {
    const int threads = options.diagnose.refit.threads;
    Preflight result;
    // Where the noise is not specified: a hundredth of how far the markers move, as the diagnosis takes it to be at
    // least.
    const Problem raw = make_problem(set, 1);
    result.moved_mm = raw.rms_mm(raw.displacement());
    result.noise_known = std::ranges::none_of(raw.is_guessed, [](char guessed) { return guessed != 0; });
    const double noise = set.position_noise.value_or(std::max(options.diagnose.resolution * result.moved_mm, 1e-9));
    const Problem problem = make_problem(set, noise);
    result.noise_mm = problem.rms_sigma();
    result.coordinates = static_cast<int>(problem.rows());
    result.independent = independent_readings(problem);
    result.tells_a_force = tells_a_force(set);

    report(progress, "the body under its loads", 0.1);
    const LinearPoint point = point_of(model, set, problem, options.diagnose, result.guess_is_sets);
    result.guess = point.explanation;
    result.nuisance_mm = problem.rms_mm(point.rig.nuisance_sd().cwiseProduct(problem.sigma));
    result.parameters = parameter_prospects(model, problem, point, threads);

    report(progress, "effects", 0.2);
    std::vector<std::shared_ptr<const EffectHypothesis>> asked;
    for (const auto& effect : catalogue())
        if (!options.diagnose.leaves_out(*effect) && !effect->sets_readings_aside() && !effect->is_last_resort())
            asked.push_back(effect);
    result.effects = effect_prospects(model, problem, point.all, signatures_at(model, problem, point, asked, threads),
                                      options.diagnose);
    if (const auto single = effect_of_single_readings(); !options.diagnose.leaves_out(*single))
        result.effects.push_back(prospect_of_single_readings(single, problem, options.diagnose));

    report(progress, "readings", 0.3);
    const Eigen::VectorXd error_mm = problem.measured - problem.pick(point.forward.markers);
    const std::vector<Suspicion> exchanged =
        exchanged_markers(problem, point.all, error_mm.cwiseQuotient(problem.sigma));
    result.suspicions = exchanged;
    for (const Suspicion& one : suspicious_readings(problem, error_mm))
        if (!is_told_by(exchanged, one)) result.suspicions.push_back(one);
    std::ranges::copy(markers_off_the_surface(set), std::back_inserter(result.suspicions));
    result.repeats = repeated_states(problem, error_mm);

    if (options.experiments) {
        report(progress, "what more states would bring", 0.4);
        result.experiments = experiment_prospects(model, set, noise, point, result.effects,
                                                  possible_experiments(model, set, problem), options.diagnose);
    }
    return result;
}

}  // namespace palpate::identify
