#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// The files of a series in the order of their numbers: all in a folder; those that fit a name with one '*'; or, with
/// `is_series`, those beside a file whose names differ from its own in the last number only. Else the file alone.
/// @throws IoError where there is none.
std::vector<std::filesystem::path> files_of_series(const std::filesystem::path& file, bool is_series);

/// Recordings that follow each other, one file each, as one. Points are those of equal names; where the files have
/// different numbers of points that displacements from rest tell apart, those of equal places at rest.
/// @throws InvalidInput where they have different points.
Recording joined_frames(std::vector<Recording> frames, const std::string& source, const FileMap& map);

}  // namespace palpate::identify
