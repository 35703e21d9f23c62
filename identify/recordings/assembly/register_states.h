#pragma once

#include <vector>

#include "identify/recordings/assembly/frames/rigid_motion.h"
#include "identify/recordings/assembly/import_report.h"
#include "identify/recordings/assembly/map/import_map.h"
#include "identify/recordings/assembly/states/rest_state.h"

namespace palpate::identify {

/// From the recordings' frame to that of the mesh: one motion for all states, or one each.
struct StateFrames {
    std::vector<RigidMotion> of_state;  // of each probe's states, one after the other
};

/// Registers by the map's rule, and tells residual and uncertainty in the report. @throws InvalidInput where there is
/// nothing to register by, and for a slip of units.
StateFrames register_states(const ImportMap& map, const std::vector<ProbeStates>& probes, const RestState& rest,
                            ImportReport& report);

}  // namespace palpate::identify
