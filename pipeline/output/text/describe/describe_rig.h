#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// How many states have a force, a tool or an actuator that acts.
std::size_t loaded_states(const identify::MeasurementSet& set);

/// What moved and drove a body in a set, and what was read of it, a line each: tools, actuators, displacements, and
/// whether any force is stated. Nothing for a set of forces and positions.
std::vector<std::string> rig_in_words(const identify::MeasurementSet& set);

/// The same for scripts: {"tools": [...], "actuators": [...], "displacements", "tells_a_force", "not_fitted_yet"}.
nlohmann::json rig_json(const identify::MeasurementSet& set);

}  // namespace palpate::pipeline
