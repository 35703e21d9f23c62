#pragma once

#include <filesystem>

#include "identify/diagnosis/diagnosis.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::pipeline {

/// Where a diagnosis names a map of stiffness: map.vtu in a folder, with "stiffness over its mean [-]" and "standard
/// deviation of ln stiffness [-]" in the body's elements. Removes what an earlier one left there.
void write_stiffness_map(const std::filesystem::path& folder, const mesh::VolumeMesh& body,
                         const identify::Diagnosis& diagnosis);

}  // namespace palpate::pipeline
