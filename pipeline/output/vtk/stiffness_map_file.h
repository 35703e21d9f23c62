#pragma once

#include <filesystem>

#include "identify/diagnosis/diagnosis.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::pipeline {

inline constexpr const char* map_regions = "map_regions";

/// Where a diagnosis names a map of stiffness, in a folder:
/// - map.vtu: "stiffness over its mean [-]", "standard deviation of ln stiffness [-]" and "part", from 1 on, 0: none,
/// in
///   the body's elements;
/// - map_regions/: the measurement set on these elements, with the parts as regions of unknown stiffness, to run next;
///   only where parts stand out and the set has no regions of its own.
/// Removes what an earlier diagnosis left there. Returns whether map_regions/ was written.
bool write_stiffness_map(const std::filesystem::path& folder, const mesh::VolumeMesh& body,
                         const identify::MeasurementSet& set, const identify::Diagnosis& diagnosis);

}  // namespace palpate::pipeline
