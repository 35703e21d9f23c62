#pragma once

#include "identify/comparison/comparison.h"
#include "identify/measurements/measurement_set.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

/// Plays every state on the model and compares the markers. Unlabelled readings are left out.
Comparison compare(const skeleton::Model& model, const MeasurementSet& set, int threads = 1);

}  // namespace palpate::identify
