#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// The text of a map.yaml for a file, to be edited: what was found out about it, and, as comments, what may be told
/// besides. @param recordings that were read of it; empty where it could not be read
/// @param told of the file already: the unit of its positions
/// @throws IoError when there is no such file.
std::string draft_map(const std::filesystem::path& file, const std::vector<Recording>& recordings,
                      const FileMap& told = {});

}  // namespace palpate::identify
