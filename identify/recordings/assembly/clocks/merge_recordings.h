#pragma once

#include <string>
#include <vector>

#include "identify/recordings/assembly/clocks/clock_report.h"
#include "identify/recordings/assembly/clocks/probe_recording.h"

namespace palpate::identify {

/// What one file of the map holds.
struct FileRecordings {
    const MappedFile* mapped = nullptr;
    std::string name;  // of the file
    std::vector<Recording> recordings;
};

/// Puts the files of each probe on one clock, in the order of the probes.
///
/// Recordings of one file share its clock. Files without any, as many frames as the first has, share its frames. Others
/// come by the map's rule: by the edges of a trigger, by a common column, which rises or falls on both sides, or by the
/// lag at which force and motion agree best. @throws InvalidInput where that is not clear, naming the file.
std::vector<ProbeRecording> merge_recordings(const ImportMap& map, std::vector<FileRecordings> files,
                                             std::vector<ClockReport>& clocks);

}  // namespace palpate::identify
