#include "identify/diagnosis/ladder/ladder_skeleton.h"

#include <algorithm>
#include <iterator>

#include "identify/diagnosis/rigged/rigged_skeleton.h"
#include "identify/effects/catalogue.h"
#include "identify/identify.h"
#include "identify/loading/readings.h"

namespace palpate::identify {
namespace {

/// A rig's identification fits all effects of a model anew, and a set that is corrected has no faults left: these are
/// added afterwards, as they were found.
skeleton::Model without_faults(skeleton::Model model) {
    std::erase_if(model.effects, [](const auto& effect) { return !find_effect(effect.name)->is_of_body(); });
    return model;
}

void add_faults(const std::vector<skeleton::EffectRecord>& effects, skeleton::Model& model) {
    std::ranges::copy_if(effects, std::back_inserter(model.effects),
                         [](const auto& effect) { return !find_effect(effect.name)->is_of_body(); });
}

}  // namespace

skeleton::Model LadderSkeleton::fitted(const std::vector<skeleton::EffectRecord>& effects, const MeasurementSet& set) {
    if (is_rigged(set)) return refitted(effects, set);
    const skeleton::Model model = with_effects(effects);
    const Calibration calibration = calibrate(model, collect_readings(model, set), *options_, {});
    near_ = calibration.coarse;
    return calibrated(model, calibration);
}

skeleton::Model LadderSkeleton::refitted(const std::vector<skeleton::EffectRecord>& effects,
                                         const MeasurementSet& set) const {
    const skeleton::Model model = with_effects(effects);
    if (is_rigged(set)) {
        IdentifyOptions of_one = *options_;
        of_one.particles = 1;  // the fit alone
        skeleton::Model result = identify_rigged(without_faults(model), set, of_one).model;
        add_faults(model.effects, result);
        return result;
    }
    return calibrated(model, calibrate(model, collect_readings(model, set), *options_, {}, &near_));
}

IdentifyResult LadderSkeleton::identified(const std::vector<skeleton::EffectRecord>& effects, const MeasurementSet& set,
                                          const Progress& progress) const {
    const skeleton::Model model = with_effects(effects);
    const bool rigged = is_rigged(set);
    IdentifyResult result = identify(rigged ? without_faults(model) : model, set, *options_, progress, &near_);
    if (rigged) add_faults(effects, result.model);
    return result;
}

skeleton::Model LadderSkeleton::with_effects(const std::vector<skeleton::EffectRecord>& effects) const {
    skeleton::Model model = *model_;
    model.effects = effects;
    return model;
}

}  // namespace palpate::identify
