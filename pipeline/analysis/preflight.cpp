#include "pipeline/analysis/preflight.h"

#include <algorithm>

#include "identify/measurements/rig/fittable.h"
#include "identify/preflight/preflight.h"
#include "mesh/errors.h"
#include "pipeline/body/reference_body.h"
#include "pipeline/output/json/preflight.h"

namespace palpate::pipeline {
namespace {

/// Without a full stop, for a sentence of its own.
std::string clause(std::string words) {
    while (words.ends_with('.')) words.pop_back();
    return words;
}

}  // namespace

PreflightOfSet judge(const identify::MeasurementSet& set, int threads, const Progress& progress) {
    const auto unfitted = identify::parts_not_fitted_yet(set);
    if (!unfitted.empty()) return {nullptr, clause(identify::in_words(unfitted))};
    if (std::ranges::none_of(set.states,
                             [](const auto& state) { return !state.readings.empty() || !state.reactions.empty(); }))
        return {nullptr, "no reading names its marker"};
    // Half as many nodes as the diagnosis takes, or fewer: strengths that are told to two digits do not ask for more.
    constexpr double coarse = 1.35;
    identify::MeasurementSet bare = set;
    if (bare.rest_volume && bare.rest_volume->nodes.rows() > 2500) bare.rest_volume.reset();
    const Reference reference = make_reference(bare, coarse * reference_edge_length(set.rest_surface), progress);
    if (!reference.body) return {nullptr, clause(reference.why_none)};
    identify::PreflightOptions options;
    options.diagnose.refit.threads = threads;
    try {
        return {to_json(identify::assess(*reference.body, set, options, progress), *reference.body, set), {}};
    } catch (const InvalidInput& e) {
        return {nullptr, clause(e.what())};
    } catch (const SolverFailure& e) {
        return {nullptr, clause(e.what())};
    }
}

}  // namespace palpate::pipeline
