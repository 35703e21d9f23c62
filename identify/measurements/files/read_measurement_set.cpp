#include <fmt/format.h>

#include <algorithm>

#include "identify/measurements/files/read_markers.h"
#include "identify/measurements/files/set_description.h"
#include "identify/measurements/files/tables.h"
#include "identify/measurements/measurement_places.h"
#include "identify/measurements/measurement_set.h"
#include "identify/measurements/rig/rig_places.h"
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

/// The tables whose rows make the states; probes.csv may be missing where another of them is there.
void read_what_acted(TableReader& reader, const SetDescription& description, const MeasurementSet& set) {
    const auto stands = [&](const char* table) { return fs::exists(set.folder / table); };
    const bool acts_otherwise = stands("motions.csv") || stands("actuations.csv");
    if (!acts_otherwise || stands("probes.csv")) reader.read_probes(set.folder / "probes.csv");
    if (stands("states.csv")) reader.read_states(set.folder / "states.csv");
    if (stands("motions.csv")) reader.read_motions(set.folder / "motions.csv");
    if (stands("actuations.csv")) reader.read_actuations(set.folder / "actuations.csv");
    if (set.states.empty())
        throw InvalidInput(
            fmt::format("{}: the table has no rows, so the set has no states. Add a row per contact and "
                        "instant.",
                        (set.folder / "probes.csv").string()));
    if (!description.is_first_format) reader.order_states();
}

}  // namespace

std::vector<LoadState> read_probes(const fs::path& file) {
    MeasurementSet set;
    TableReader(set, SetUnits{}).read_probes(file);
    if (set.states.empty())
        throw InvalidInput(fmt::format("{}: the table has no rows. Add a row per contact and instant.", file.string()));
    return set.states;
}

std::vector<Marker> read_markers(const fs::path& file) {
    MeasurementSet set;
    TableReader(set, SetUnits{}).read_markers(file);
    if (set.markers.empty())
        throw InvalidInput(fmt::format("{}: the table has no rows. Add one a marker.", file.string()));
    return set.markers;
}

MeasurementSet read_measurement_set(const fs::path& path) {
    MeasurementSet set;
    const SetDescription description = read_set_description(description_of(path), set);
    TableReader reader(set, description.units);
    read_what_acted(reader, description, set);

    // Where every state has its full field, markers may be missing.
    reader.find_fields(set.folder / "field");
    const bool has_all_fields = std::ranges::none_of(set.states, [](const LoadState& s) { return s.field.empty(); });
    const auto stands = [&](const char* table) { return fs::exists(set.folder / table); };
    const bool is_read_otherwise = stands("reactions.csv") || stands("displacements.csv");
    const bool are_positions_wanted = !(has_all_fields || is_read_otherwise) || stands("positions.csv");
    const bool are_displacements_wanted = description.displacements_since || stands("displacements.csv");
    if (are_positions_wanted || are_displacements_wanted || stands("markers.csv"))
        reader.read_markers(set.folder / "markers.csv");
    if (are_positions_wanted) reader.read_positions(set.folder / "positions.csv");
    if (are_displacements_wanted)
        reader.read_displacements(set.folder / "displacements.csv", description.displacements_since);
    if (stands("reactions.csv")) reader.read_reactions(set.folder / "reactions.csv");
    const bool has_readings =
        std::ranges::any_of(set.states, [](const LoadState& s) { return !s.readings.empty() || !s.reactions.empty(); });
    if (!has_readings && !has_all_fields)
        throw InvalidInput(
            fmt::format("{}: the set has no readings. Add measured marker positions, or a full field for "
                        "every state.",
                        (set.folder / "positions.csv").string()));
    const fs::path loads = set.folder / "motion_probes.csv", moved = set.folder / "motion_positions.csv";
    if (fs::exists(loads) || fs::exists(moved)) reader.read_recordings(loads, moved);
    check_places(set);
    check_tools(set);
    check_actuators(set);
    return set;
}

}  // namespace palpate::identify
