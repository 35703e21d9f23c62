#pragma once

#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// Where no state of a set has a load, but its density or Young's modulus is told: its weight is the load. Standard
/// gravity is put into the set, along the direction in which the body sags like the readings, an axis of the set's
/// frame where that fits; `notes` says so. Nothing is changed where something is known to act, or no direction explains
/// most of what was read.
void take_weight_as_load(identify::MeasurementSet& set, std::vector<std::string>& notes);

}  // namespace palpate::pipeline
