#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// Do the bytes begin like a C3D file?
bool is_c3d(const std::string& bytes);

/// Points, and, on a clock of their own, analogs of a C3D file [C-Motion, The C3D File Format, 2008], by any of its
/// three kinds of processor, with integers or reals. Points of a negative residual were not seen.
/// @throws InvalidInput where it is cut off or broken.
std::vector<Recording> read_c3d(const std::string& bytes, const std::filesystem::path& file, const FileMap& map);

}  // namespace palpate::identify
