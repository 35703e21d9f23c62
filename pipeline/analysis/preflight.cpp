#include "pipeline/analysis/preflight.h"

#include <algorithm>

#include "identify/measurements/rig/fittable.h"
#include "mesh/errors.h"
#include "pipeline/body/reference_body.h"

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
    if (!unfitted.empty()) return {.why_none = clause(identify::in_words(unfitted))};
    if (std::ranges::none_of(set.states,
                             [](const auto& state) { return !state.readings.empty() || !state.reactions.empty(); }))
        return {.why_none = "no reading names its marker"};
    // Half as many nodes as the diagnosis takes, or fewer: strengths that are told to two digits do not ask for more.
    constexpr double coarse = 1.35;
    identify::MeasurementSet bare = set;
    if (bare.rest_volume && bare.rest_volume->nodes.rows() > reference_nodes) bare.rest_volume.reset();
    Reference reference = make_reference(bare, coarse * reference_edge_length(set.rest_surface), progress);
    if (!reference.body) return {.why_none = clause(reference.why_none)};
    identify::PreflightOptions options;
    options.diagnose.refit.threads = threads;
    try {
        identify::Preflight preflight = identify::assess(*reference.body, set, options, progress);
        return {.body = std::move(reference.body), .preflight = std::move(preflight)};
    } catch (const InvalidInput& e) {
        return {.why_none = clause(e.what())};
    } catch (const SolverFailure& e) {
        return {.why_none = clause(e.what())};
    }
}

}  // namespace palpate::pipeline
