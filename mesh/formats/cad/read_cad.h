#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// The surface of a STEP or IGES file in triangles [mm], within `cad_chord` of the diagonal of the true one. Several
/// solids are united to one body where they touch; open faces are sewn together. Notes tell how many there were, and
/// the tolerance. OpenCASCADE reads in a child process, with limits on time and memory.
/// @throws InvalidInput when the file is no such file, holds no faces, or this program was built without OpenCASCADE;
/// SolverFailure when OpenCASCADE crashes or does not come to an end.
Surface read_cad(const std::filesystem::path& file, std::vector<std::string>& notes);

/// How far triangles may be from the true surface, as a share of the body's diagonal.
inline constexpr double cad_chord = 0.0005;

}  // namespace palpate::mesh
