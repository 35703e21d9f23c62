#pragma once

#include <nlohmann/json.hpp>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// What a page needs to know of a measurement set in order to play it: markers, states with what acts and what was
/// read, in mm, N, MPa. Readings are rounded to 1e-6 mm; what is missing or unknown is null. Surface, supports and
/// fields are left out.
nlohmann::json set_as_text(const identify::MeasurementSet& set);

/// What a page needs to know of an actuator, in mm: a tendon by its path, a cavity by a point of its wall.
/// @throws InvalidInput for a cavity that a surface describes.
nlohmann::json actuator_as_text(const mesh::Actuator& actuator);
mesh::Actuator actuator_from_text(const nlohmann::json& text);

/// The set again. @throws nlohmann::json::exception for what `set_as_text` has not written.
identify::MeasurementSet set_from_text(const nlohmann::json& text);

}  // namespace palpate::pipeline
