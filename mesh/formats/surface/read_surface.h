#pragma once

#include <filesystem>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// Reads a surface file, whose format the extension tells (surface_formats.h); polygons are triangulated.
/// Nothing is repaired here, STL corners are not welded.
/// @throws IoError when the file cannot be opened; InvalidInput, naming file and line or element, when its extension
/// names no format, when it is empty, truncated, no mesh, holds coordinates that are not finite or indices out of
/// range.
Surface read_surface(const std::filesystem::path& file);

/// Writes a surface file in the format that the extension tells, whole or not at all.
/// @throws IoError when it cannot be written; InvalidInput, listing the extensions that can, when this one is not
/// written.
void write_surface(const std::filesystem::path& file, const Surface& surface);

}  // namespace palpate::mesh
