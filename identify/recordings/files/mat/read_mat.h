#pragma once

#include <filesystem>
#include <string>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// Do the bytes begin like those of a MATLAB file?
bool is_mat(const std::string& bytes);

/// Ncorr's `data_dic_save`, or a structure of MultiDIC that has `Points3D`. @throws InvalidInput where it is neither.
Recording read_mat(const std::filesystem::path& file, const FileMap& map);

}  // namespace palpate::identify
