#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// A set's actuators as text, each with the range of its slider, what it was set to and half as far again, and the
/// unit. Null in place of one that no state sets, or that acts on nothing of the model, which `notes` then tell.
nlohmann::json actuator_sliders(const identify::MeasurementSet& set, const skeleton::Model& model,
                                std::vector<std::string>& notes);

}  // namespace palpate::pipeline
