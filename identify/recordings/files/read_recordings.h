#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// Reads what a rig wrote: C3D, TRC, CSV of OptiTrack Motive and of Vicon, exports of testing machines (Bluehill,
/// testXpert) and of image correlation (GOM, VIC-3D, MuDIC, DICe; Ncorr and MultiDIC as .mat), points of VTK and PLY
/// files, and tables of numbers. The content tells which; what it cannot tell, the map does.
/// @param file or, of a series of files that are frames, a folder that holds nothing else, or a pattern with one '*' in
/// the last part: "scan_*.ply". They are taken in the order of their numbers.
/// @return one recording for each clock that the file has, at least one; each holds points or channels.
/// @throws IoError; InvalidInput where the content is broken, or is none of these: the message tells what was
/// recognised, what was not, and a map to start from.
std::vector<Recording> read_recordings(const std::filesystem::path& file, const FileMap& map = {});

}  // namespace palpate::identify
