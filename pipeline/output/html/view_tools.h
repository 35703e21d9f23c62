#pragma once

#include <nlohmann/json.hpp>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// Is a row of a file of this state?
bool is_of_state(const nlohmann::json& row, const identify::StateName& state);

/// What of a set's tools stays the same in all states, as page/view/tools.js reads it: name and `origin` at rest; of a
/// mesh its `surface`, or "triangles_left_out" where these are more than a page has room for; of a grip its `patch`,
/// the triangles of the body's surface that lie in its regions. `points`, `triangles`: of the body at rest.
nlohmann::json tools_at_rest(const identify::MeasurementSet& set, const Points& points, const Triangles& triangles);

/// The tools of a state: where each is, null where a coordinate is left free; how it has `moved` and `turned` from
/// rest, null along an axis that is left free; the radius of a ball or a punch and, of the latter, where it presses to;
/// and the force on the body, null along an axis that was not read.
nlohmann::json tools_in_state(const identify::MeasurementSet& set, const identify::StateName& name);

/// What a model makes of the tools' forces in a state. `comparison`: as in compare.json, or null.
nlohmann::json modelled_tool_forces(const nlohmann::json& comparison, const identify::StateName& state);

}  // namespace palpate::pipeline
