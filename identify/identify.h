#pragma once

#include "identify/inference/identify_result.h"
#include "identify/inference/problem/identify_options.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

struct UniformFit;

/// Finds the stiffness of every link, so that the model follows the measurements. The model gets the most probable
/// stiffnesses together: marginal means of skewed, correlated distributions give a stiffer body that fits several times
/// worse. `near`: a uniform fit to other readings of the same model saves some time.
/// @throws InvalidInput when the set holds no loaded state with readings, or none of what the method needs.
IdentifyResult identify(const skeleton::Model& model, const MeasurementSet& set, const IdentifyOptions& options,
                        const Progress& progress = {}, const UniformFit* near = nullptr);

}  // namespace palpate::identify
