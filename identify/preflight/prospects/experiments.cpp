#include "identify/preflight/prospects/experiments.h"

#include <algorithm>
#include <cmath>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// The set with an experiment that reads every marker, and of each tool that touches what the set reads of it.
MeasurementSet with_states(const MeasurementSet& set, const Experiment& experiment) {
    MeasurementSet result = set;
    for (LoadState state : experiment.states) {
        for (std::size_t m = 0; m < set.markers.size(); ++m)
            state.readings.push_back({.marker = static_cast<int>(m), .position = set.markers[m].rest});
        for (const mesh::ToolMotion& motion : state.motions) {
            for (const LoadState& other : set.states) {
                const auto read = std::ranges::find(other.reactions, motion.tool, &ReactionReading::tool);
                if (read == other.reactions.end()) continue;
                state.reactions.push_back(*read);
                break;
            }
        }
        result.states.push_back(state);
    }
    return result;
}

/// Signatures in states where the body is turned or vented: an effect's numbers are others there.
void turn_numbers(const BodyModel& model, const Problem& problem, const Experiment& experiment, int first_state,
                  EffectSignature& signature) {
    const std::vector<EffectNumber> numbers = signature.effect->numbers(model, problem);
    const Eigen::Index p = std::ssize(numbers);
    if (p == 0 || signature.columns.alternatives() != 1 || signature.columns.columns.cols() != p) return;
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const int added = problem.state[n] - first_state;
        if (added < 0) continue;
        const ProbeConditions& conditions = experiment.conditions[static_cast<std::size_t>(added)];
        if (conditions.turn.isIdentity(0) && !conditions.vented) continue;
        Eigen::MatrixXd map(p, p);
        const Eigen::VectorXd none = signature.effect->under(conditions, Eigen::VectorXd::Zero(p));
        for (Eigen::Index j = 0; j < p; ++j)
            map.col(j) = signature.effect->under(conditions, Eigen::VectorXd::Unit(p, j)) - none;
        signature.columns.columns.row(n) = signature.columns.columns.row(n).eval() * map;
    }
}

}  // namespace

std::vector<ExperimentProspect> experiment_prospects(const BodyModel& model, const MeasurementSet& set, double noise,
                                                     const LinearPoint& guess,
                                                     const std::vector<EffectProspect>& before,
                                                     const std::vector<Experiment>& experiments,
                                                     const DiagnoseOptions& options) {
    std::vector<std::shared_ptr<const EffectHypothesis>> effects;
    for (const EffectProspect& one : before)
        if (!one.effect->sets_readings_aside() && !one.effect->is_of_links()) effects.push_back(one.effect);
    std::vector<ExperimentProspect> result;
    const auto try_out = [&](const Experiment& experiment) {
        const MeasurementSet more = with_states(set, experiment);
        Problem problem = make_problem(more, noise);
        const LinearPoint point =
            linearise(model, problem, guess.explanation, options.mesh_error, options.refit.threads, &guess);
        const auto first = static_cast<int>(set.states.size());
        const Eigen::VectorXd answered = problem.pick(point.forward.markers);
        for (Eigen::Index n = 0; n < problem.rows(); ++n)
            if (problem.state[n] >= first) problem.measured[n] = answered[n];
        std::vector<EffectSignature> signatures = signatures_at(model, problem, point, effects, options.refit.threads);
        for (EffectSignature& signature : signatures) turn_numbers(model, problem, experiment, first, signature);
        const std::vector<EffectProspect> after = effect_prospects(model, problem, point.all, signatures, options);

        ExperimentProspect prospect{.experiment = experiment};
        for (const EffectProspect& then : after) {
            const EffectProspect& now = *std::ranges::find(before, then.effect, &EffectProspect::effect);
            constexpr double enough = 0.5;      // of the cases
            constexpr double noticeable = 0.8;  // of the strength: a fifth less
            const bool eases = then.least < noticeable * now.least || then.share > now.share + (1 - noticeable);
            if (!then.why_not.empty() || !eases) continue;
            prospect.gains.push_back({then.effect->name(), now.share, then.share, now.least, then.least});
            if (then.share >= enough && now.share < enough) prospect.opens.push_back(then.effect->name());
        }
        if (!prospect.gains.empty()) result.push_back(std::move(prospect));
    };
    for (const Experiment& experiment : experiments) {
        try {
            try_out(experiment);
        } catch (const SolverFailure&) {  // more than the body bears, as far as is known: none to propose
        }
    }
    const auto worth = [](const ExperimentProspect& one) {
        double eased = 0;  // a factor of ten of one effect is as good as that of another
        for (const ExperimentGain& gain : one.gains) {
            constexpr double most = 10;
            const double now = std::min(gain.least_before, 1e4), then = std::max(gain.least_after, 1e-4);
            eased += std::log(std::clamp(now / then, 1.0, most));
        }
        return std::pair(one.opens.size(), eased);
    };
    std::ranges::stable_sort(result, std::greater{}, worth);
    return result;
}

}  // namespace palpate::identify
