#pragma once

#include <map>
#include <string>
#include <vector>

#include "identify/recordings/assembly/register_states.h"

namespace palpate::identify {

/// Adds the markers to a set: those that the map names, else all points that it does not use otherwise, where they
/// rest. Markers that stand off the surface are tied to its nearest point. What is left out, as nobody knows where it
/// rests, is told. Returns each marker's index by its point's name. `frame`: of the state of rest.
/// @throws InvalidInput where points have names but no place.
std::map<std::string, int> add_markers(const ImportMap& map, const std::vector<ProbeStates>& probes,
                                       const RestState& rest, const RigidMotion& frame, MeasurementSet& set,
                                       ImportReport& report);

}  // namespace palpate::identify
