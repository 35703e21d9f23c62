#pragma once

#include <vector>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/files/text/decoding/text_file.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

// Text files of motion capture. Each is recognised by what it begins with.

bool is_trc(const TextFile& text);
bool is_motive(const TextFile& text);
bool is_vicon(const TextFile& text);

/// TRC of Motion Analysis and OpenSim. @throws InvalidInput.
Recording read_trc(const TextFile& text, const FileMap& map);

/// CSV of OptiTrack Motive, versions 1.2 and later: its markers; rigid bodies and bones are left out, as the solved
/// places of a rigid body's markers are where the measured ones are there. @throws InvalidInput.
Recording read_motive(const TextFile& text, const FileMap& map);

/// CSV of Vicon Nexus and Tracker: trajectories, and, on clocks of their own, devices and model outputs; events.
/// @throws InvalidInput.
std::vector<Recording> read_vicon(const TextFile& text, const FileMap& map);

}  // namespace palpate::identify
