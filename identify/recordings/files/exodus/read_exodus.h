#pragma once

#include <filesystem>
#include <string>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// Do the bytes begin like those of a netCDF file, as Exodus files are, classic or on HDF5?
bool is_exodus(const std::string& bytes);

/// The nodes of an Exodus II file over its times, as DICe and finite-element programs write them: coordinates at rest
/// and a displacement. @throws InvalidInput where it is no whole one, or its nodes do not move.
Recording read_exodus(const std::filesystem::path& file, const FileMap& map);

}  // namespace palpate::identify
