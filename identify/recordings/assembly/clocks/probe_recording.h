#pragma once

#include <string>
#include <vector>

#include "identify/recordings/assembly/clocks/signal.h"
#include "identify/recordings/assembly/map/import_map.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

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

/// Adds the map's quantities that this probe's points tell, beginning with 0.
void add_quantities(const ImportMap& map, ProbeRecording& probe);

/// The direction in which all points move most, and where they are along it: the leading principal component.
Signal leading_motion(const ProbeRecording& probe);

}  // namespace palpate::identify
