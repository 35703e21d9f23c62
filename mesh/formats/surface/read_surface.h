#pragma once

#include <filesystem>
#include <string>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// Reads STL (binary and text), OBJ, PLY, OFF or VTP, told apart by extension; polygons are triangulated.
/// Nothing is repaired here, STL corners are not welded.
/// @throws IoError when the file cannot be opened; InvalidInput, naming file and line or element, when it is
/// empty, truncated, no mesh, holds coordinates that are not finite or indices out of range.
Surface read_surface(const std::filesystem::path& file);

/// The extension in lower case, with its dot.
/// @throws InvalidInput, listing those allowed, when it names no surface format.
std::string surface_extension(const std::filesystem::path& file);

/// Writes STL (binary), OBJ, PLY, OFF or VTP by extension, whole or not at all.
void write_surface(const std::filesystem::path& file, const Surface& surface);

}  // namespace palpate::mesh
