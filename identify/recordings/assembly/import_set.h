#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "identify/recordings/assembly/import_report.h"

namespace palpate::identify {

struct ImportOptions {
    std::filesystem::path map;                 // map.yaml
    std::vector<std::filesystem::path> files;  // of the rig, or folders of them; those that the map names are taken
    std::filesystem::path mesh = {};           // in place of the map's
    std::string states = {};                   // "plateaus", "every=0.1s" or "all", in place of the map's
    std::string registration = {};             // "auto", "icp", "none" or a .csv, likewise
    std::string unit = {};                     // of the files' positions, likewise
};

struct ImportedSet {
    MeasurementSet set;
    ImportReport report;
};

/// A measurement set out of what a rig wrote: files read, points named and their tracks mended, clocks merged, states
/// found, frames registered. Nothing is written. @throws IoError, InvalidInput.
ImportedSet import_set(const ImportOptions& options);

}  // namespace palpate::identify
