#pragma once

#include <map>
#include <string>
#include <vector>

#include "identify/recordings/assembly/states/imported_state.h"

namespace palpate::identify {

/// The states of one probe.
struct ProbeStates {
    const ProbeRecording* probe = nullptr;
    std::vector<ImportedState> states;
};

/// Where the points of files rest that tell displacements: the place that each counts from, in the file's frame [mm].
/// `has_moved`: the first frames show some of them elsewhere.
struct PlacesOfFiles {
    std::map<std::string, Vec3> at;
    bool has_moved = false;
};

/// Adds those of a recording.
void add_places_at_rest(const Recording& recording, PlacesOfFiles& places);

/// The body at rest.
struct RestState {
    const ProbeRecording* probe = nullptr;  // whose points these are
    ImportedState state;
    bool is_of_files = false;  // no state shows it: points are where the files' displacements count from
};

/// By the map's rule: a probe's first state, with the places of files where these are wanted.
/// @throws InvalidInput where the map names a probe that is none, or asks for places that no file tells.
RestState rest_state(const ImportMap& map, const std::vector<ProbeStates>& probes, const PlacesOfFiles& places,
                     std::vector<std::string>& notes);

}  // namespace palpate::identify
