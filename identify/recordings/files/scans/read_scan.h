#pragma once

#include <filesystem>
#include <string>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// Do the bytes begin like those of a file that read_scan() reads?
bool is_scan(const std::string& bytes);

/// The points of a PLY or VTK file (legacy, VTU, VTP), a single frame; of a series (PVD) its files as frames.
/// @throws InvalidInput; IoError where a file of the series is missing.
Recording read_scan(const std::string& bytes, const std::filesystem::path& file, const FileMap& map);

}  // namespace palpate::identify
