#include "identify/diagnosis/ladder/understood_set.h"

#include <fmt/format.h>

#include <algorithm>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"

namespace palpate::identify {

std::vector<skeleton::EffectRecord> estimate(const Diagnosis& diagnosis) {
    std::vector<skeleton::EffectRecord> result;
    const Refit& fit = diagnosis.best();
    for (std::size_t e = 0; e < fit.explanation.effects.size(); ++e) {
        result.push_back(fit.explanation.effects[e]->record(fit.numbers[e], fit.explanation.values[e]));
    }
    for (const Candidate& candidate : diagnosis.ranking) {
        const bool set_aside = candidate.effect->sets_readings_aside() && !diagnosis.outliers.readings.empty();
        if (set_aside) result.push_back(candidate.estimate.effect);
    }
    return result;
}

MeasurementSet understood(const MeasurementSet& set, const std::vector<skeleton::EffectRecord>& effects,
                          const std::vector<int>& outliers) {
    MeasurementSet result = without_readings(set, outliers);
    for (const skeleton::EffectRecord& effect : effects) result = find_effect(effect.name)->corrected(result, effect);
    return result;
}

bool set_readings_aside(const std::vector<std::string>& effects) {
    return std::ranges::any_of(effects,
                               [](const std::string& name) { return find_effect(name)->sets_readings_aside(); });
}

void refuse_what_cannot_show(const EffectHypothesis& effect, const BodyModel& body, const MeasurementSet& set) {
    const Problem problem = make_problem(set, 1);
    const bool spread = effect.has_memory() && !problem.by_stage;
    const bool is_fitted = !effect.sets_readings_aside();
    if (!is_fitted || !effect.numbers(body, spread ? problem.stage_by_stage() : problem).empty()) return;
    if (effect.is_of_links())
        throw InvalidInput(fmt::format(
            "The effect '{}' cannot show in a solid: links alone have it. Judge it on the skeleton.", effect.name()));
    const EffectDescription& text = effect.description();
    throw InvalidInput(fmt::format(
        "The effect '{}' cannot show in this body and this set{}. Leave it out, or measure what shows it: {}.",
        effect.name(), text.why_unshown.empty() ? "" : ": " + text.why_unshown, text.reveals));
}

}  // namespace palpate::identify
