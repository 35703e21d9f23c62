#pragma once

#include "identify/measurements/measurement_set.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::identify {

/// The full displacement field of a state.
struct Field {
    mesh::VolumeMesh mesh;  // at rest
    Points displacement;    // of its nodes (n x 3) [mm]
};

/// The field of a state that has one, in mm. @throws IoError, InvalidInput when its file has no point array
/// `displacement` of three components.
Field read_field(const LoadState& state);

/// The set with markers: its own where it has readings, else up to `markers` vertices of its rest surface, read from
/// the fields of the states that have one.
MeasurementSet with_markers_of_fields(const MeasurementSet& set, int markers = 300);

}  // namespace palpate::identify
