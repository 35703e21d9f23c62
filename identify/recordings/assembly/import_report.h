#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/recordings/assembly/clocks/clock_report.h"
#include "identify/recordings/assembly/frames/rigid_motion.h"

namespace palpate::identify {

/// What became of a probe.
struct ProbeReport {
    int probe = 0;
    std::vector<std::string> files;
    double seconds = 0;
    int points = 0, channels = 0, states = 0;
};

/// What an import has found, merged and left open.
struct ImportReport {
    std::vector<ProbeReport> probes;
    std::vector<ClockReport> clocks;
    std::optional<Registration> registration;
    std::string registered_by;         // in words
    std::vector<std::string> notes;    // in whole sentences
    std::vector<std::string> markers;  // the recorded point of each marker of the set
};

/// For people, some lines.
std::string describe(const ImportReport& report);

}  // namespace palpate::identify
