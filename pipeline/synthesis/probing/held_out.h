#pragma once

#include <functional>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// The set with only those states that `keep` holds for.
identify::MeasurementSet states_of(const identify::MeasurementSet& set,
                                   const std::function<bool(const identify::LoadState&)>& keep);

}  // namespace palpate::pipeline
