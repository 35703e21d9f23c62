#include <fmt/format.h>

#include <algorithm>

#include "identify/measurements/files/tables.h"
#include "identify/measurements/measurement_places.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"

namespace palpate::identify {

namespace fs = std::filesystem;

namespace {

fs::path description_of(const fs::path& path) {
    if (!fs::exists(path)) throw IoError(fmt::format("{}: no such file or folder.", path.string()));
    if (!fs::is_directory(path)) return path;
    if (!fs::exists(path / "set.yaml"))
        throw IoError(
            fmt::format("{}: the folder holds no set.yaml. A measurement set is described by one.", path.string()));
    return path / "set.yaml";
}

}  // namespace

std::vector<LoadState> read_probes(const fs::path& file) {
    MeasurementSet set;
    TableReader(set, SetUnits{}).read_probes(file);
    if (set.states.empty())
        throw InvalidInput(fmt::format("{}: the table has no rows. Add a row per contact and instant.", file.string()));
    return set.states;
}

MeasurementSet read_measurement_set(const fs::path& path) {
    MeasurementSet set;
    const SetUnits units = read_set_description(description_of(path), set);

    TableReader reader(set, units);
    reader.read_probes(set.folder / "probes.csv");
    if (fs::exists(set.folder / "states.csv")) reader.read_states(set.folder / "states.csv");
    if (set.states.empty())
        throw InvalidInput(
            fmt::format("{}: the table has no rows, so the set has no states. Add a row per contact and "
                        "instant.",
                        (set.folder / "probes.csv").string()));

    // Where every state has its full field, markers may be missing.
    reader.find_fields(set.folder / "field");
    const bool has_all_fields = std::ranges::none_of(set.states, [](const LoadState& s) { return s.field.empty(); });
    const auto wanted = [&](const char* table) { return !has_all_fields || fs::exists(set.folder / table); };
    if (wanted("markers.csv")) reader.read_markers(set.folder / "markers.csv");
    if (wanted("positions.csv")) reader.read_positions(set.folder / "positions.csv");
    const bool has_readings = std::ranges::any_of(set.states, [](const LoadState& s) { return !s.readings.empty(); });
    if (!has_readings && !has_all_fields)
        throw InvalidInput(
            fmt::format("{}: the set has no readings. Add measured marker positions, or a full field for "
                        "every state.",
                        (set.folder / "positions.csv").string()));
    const fs::path loads = set.folder / "motion_probes.csv", moved = set.folder / "motion_positions.csv";
    if (fs::exists(loads) || fs::exists(moved)) reader.read_recordings(loads, moved);
    check_places(set);
    return set;
}

}  // namespace palpate::identify
