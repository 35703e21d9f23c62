#pragma once

#include <string>
#include <vector>

#include "identify/recordings/assembly/clocks/signal.h"
#include "identify/recordings/assembly/import_report.h"
#include "identify/recordings/assembly/map/import_map.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// What one file of the map holds.
struct FileRecordings {
    const MappedFile* mapped = nullptr;
    std::string name;  // of the file
    std::vector<Recording> recordings;
};

struct NamedSignal {
    std::string name, unit;
    Signal signal;
};

/// All that the files of one probe hold, on one clock: that of the first that shows points.
struct ProbeRecording {
    int probe = 0;
    std::vector<std::string> files;
    Eigen::VectorXd times;  // of the frames [s], from 0
    bool has_clock = false;
    bool is_planar = false;             // no point has a third coordinate
    std::vector<RecordedPoint> points;  // in these frames
    std::vector<NamedSignal> channels;  // each at its own times, on this clock; the map's quantities among them
    std::vector<MappedValue> values;
    bool values_act_always = false;

    const NamedSignal* channel(const std::string& name) const;
    const RecordedPoint* point(const std::string& name) const;
};

/// Puts the files of each probe on one clock, in the order of the probes.
///
/// Recordings of one file share its clock. Files without any, as many frames as the first has, share its frames. Others
/// come by the map's rule: by the edges of a trigger, by a common column, which rises or falls on both sides, or by the
/// lag at which force and motion agree best. @throws InvalidInput where that is not clear, naming the file.
std::vector<ProbeRecording> merge_recordings(const ImportMap& map, std::vector<FileRecordings> files,
                                             ImportReport& report);

}  // namespace palpate::identify
