#pragma once

#include <vector>

#include "identify/inference/identify_result.h"
#include "identify/inference/maximum/calibrate.h"
#include "identify/inference/problem/identify_options.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

/// The skeleton on the steps of a ladder: with a step's effects, and with the stiffnesses that are most probable then.
/// Fits to other readings begin where that of the last step ended.
class LadderSkeleton {
public:
    /// Keeps references.
    LadderSkeleton(const skeleton::Model& model, const IdentifyOptions& options) : model_(&model), options_(&options) {}

    /// Without particles; keeps its uniform fit for the next.
    skeleton::Model fitted(const std::vector<skeleton::EffectRecord>& effects, const MeasurementSet& set);
    /// The same from the last step's, to other readings.
    skeleton::Model refitted(const std::vector<skeleton::EffectRecord>& effects, const MeasurementSet& set) const;
    /// With particles: the model that is delivered.
    IdentifyResult identified(const std::vector<skeleton::EffectRecord>& effects, const MeasurementSet& set,
                              const Progress& progress) const;

private:
    skeleton::Model with_effects(const std::vector<skeleton::EffectRecord>& effects) const;

    const skeleton::Model* model_;
    const IdentifyOptions* options_;
    UniformFit near_{};  // on the last step
};

}  // namespace palpate::identify
