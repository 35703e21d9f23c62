#pragma once

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/files/text/number_rows.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// The times of frames that a file tells in seconds in its second column, unless the map tells their rate.
/// @throws InvalidInput as set_times.
void set_frame_times(const TextFile& text, const NumberRows& rows, const FileMap& map, Recording& recording);

}  // namespace palpate::identify
