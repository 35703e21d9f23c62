#pragma once

#include <vector>

#include "identify/recordings/assembly/register_states.h"

namespace palpate::identify {

/// The map's set with markers and states. Markers that stand off the surface are tied to its nearest point; what a load
/// cell reads without load, and how that drifts, is told. @throws InvalidInput.
MeasurementSet filled_set(const ImportMap& map, const std::vector<ProbeStates>& probes, const RestState& rest,
                          const StateFrames& frames, ImportReport& report);

}  // namespace palpate::identify
