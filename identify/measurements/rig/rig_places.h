#pragma once

#include <string>

#include "identify/measurements/measurement_set.h"
#include "identify/measurements/rest_body.h"

namespace palpate::identify {

/// @throws InvalidInput for a tool that starts inside the body by more than 2 % of its radius; `where` begins the
/// message.
void check_starts_outside(const mesh::Tool& tool, const mesh::Surface& rest, const std::string& where);

/// @throws InvalidInput for a tendon with a point outside of the body by more than 1 % of its longest side; `where`
/// begins the message.
void check_tendon(const mesh::TendonActuator& tendon, const RestBody& body, const std::string& name,
                  const std::string& where);

/// What contradicts itself, or comes to nothing: motion and force of one contact at once; material that is gripped and
/// held; a tool that moves and no reading answers. Notes tell of tools that never move or never come near the body, and
/// of turns that mean nothing.
/// @throws InvalidInput.
void check_tools(MeasurementSet& set);

/// Cavities that are none, or are under two pressures; tendons outside of the body. Notes tell of actuators that never
/// act. @throws InvalidInput.
void check_actuators(MeasurementSet& set);

}  // namespace palpate::identify
