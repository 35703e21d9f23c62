#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "identify/set/measurement_places.h"
#include "identify/set/measurement_set.h"
#include "identify/set/set_description.h"
#include "mesh/errors.h"
#include "mesh/io/csv_table.h"
#include "mesh/io/words.h"

namespace palpate::identify {

namespace fs = std::filesystem;
using mesh::CsvTable;

namespace {

/// What identifies a state in every table.
using StateKey = std::pair<int, double>;  // probe, time

StateKey state_key(const CsvTable& table, int row) { return {table.integer(row, "probe"), table.number(row, "time")}; }

Vec3 vector(const CsvTable& table, int row, const std::array<std::string, 3>& columns) {
    return {table.number(row, columns[0]), table.number(row, columns[1]), table.number(row, columns[2])};
}

Vec3 vector_if_given(const CsvTable& table, int row, const std::array<std::string, 3>& columns) {
    return {table.at(row, columns[0]), table.at(row, columns[1]), table.at(row, columns[2])};
}

/// Fills markers and states of a set, table by table.
class TableReader {
public:
    TableReader(MeasurementSet& set, const SetUnits& units) : set_(set), units_(units) {}

    void read_probes(const fs::path& file);
    void read_states(const fs::path& file);
    void find_fields(const fs::path& folder);
    void read_markers(const fs::path& file);
    void read_positions(const fs::path& file);

private:
    LoadState& state(const StateKey& key) {
        const auto [entry, is_new] = index_of_.try_emplace(key, set_.states.size());
        if (is_new) {
            LoadState& added = set_.states.emplace_back();
            added.probe = key.first;
            added.time = key.second;
        }
        return set_.states[entry->second];
    }
    /// @throws InvalidInput where time is negative, or runs backwards within a probe.
    void check_time(const StateKey& key, const std::string& where);
    Reading read_position(const CsvTable& table, int row) const;

    MeasurementSet& set_;
    const SetUnits& units_;
    std::map<StateKey, std::size_t> index_of_;  // of the states
    std::map<int, double> last_time_;           // of each probe, so far
    std::map<int, int> marker_of_;              // id in the files -> index
};

void TableReader::check_time(const StateKey& key, const std::string& where) {
    const auto [probe, time] = key;
    if (time < 0)
        throw InvalidInput(fmt::format(
            "{}, column time: {} is negative. Count time from the beginning of the probe, which is 0.", where, time));
    const auto [last, is_first] = last_time_.try_emplace(probe, time);
    if (time < last->second)
        throw InvalidInput(
            fmt::format("{}, column time: {} comes after {} in probe {}. Put its rows in the order in which they "
                        "happened.",
                        where, time, last->second, probe));
    last->second = time;
}

void TableReader::read_probes(const fs::path& file) {
    const CsvTable table(file, {"probe", "time", "x", "y", "z", "fx", "fy", "fz", "radius"});
    for (int row = 0; row < table.rows(); ++row) {
        const StateKey key = state_key(table, row);
        check_time(key, table.where(row));
        LoadState& loaded = state(key);
        const Vec3 force = units_.force * vector(table, row, {"fx", "fy", "fz"});
        if (force.isZero(0)) continue;  // unloaded, or one contact less
        const double radius = units_.length * table.number(row, "radius");
        if (radius < 0)
            throw InvalidInput(
                fmt::format("{}, column radius: {} is negative. Give the radius of the contact patch, or 0 "
                            "for the nearest surface point.",
                            table.where(row), table.number(row, "radius")));
        loaded.contacts.push_back({units_.length * vector(table, row, {"x", "y", "z"}), force, radius});
    }
}

void TableReader::read_states(const fs::path& file) {
    const CsvTable table(file, {"probe", "time"}, {"gx", "gy", "gz", "pressure"});
    std::set<StateKey> seen;
    for (int row = 0; row < table.rows(); ++row) {
        const StateKey key = state_key(table, row);
        if (!seen.insert(key).second)
            throw InvalidInput(fmt::format("{}: probe {} at time {} has a row already. Keep one.", table.where(row),
                                           key.first, key.second));
        LoadState& known = state(key);
        known.pressure = table.at(row, "pressure");
        known.gravity = units_.length * vector_if_given(table, row, {"gx", "gy", "gz"});
        if (known.gravity.array().isNaN().any() && !known.gravity.array().isNaN().all())
            throw InvalidInput(fmt::format(
                "{}: gravity is known by part only. Give gx, gy and gz, or leave all three empty.", table.where(row)));
    }
}

void TableReader::find_fields(const fs::path& folder) {
    if (!fs::is_directory(folder)) return;
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (entry.path().extension() != ".vtu") continue;
        const std::string stem = entry.path().stem().string();
        const auto cut = std::min(stem.find('_'), stem.size());
        const auto probe = mesh::parse_integer(stem.substr(0, cut));
        const auto time = mesh::parse_number(stem.substr(std::min(cut + 1, stem.size())));
        const auto found = probe && time ? index_of_.find({*probe, *time}) : index_of_.end();
        if (found == index_of_.end())
            throw InvalidInput(
                fmt::format("{}: no state has this name. Name it <probe>_<time>.vtu by a row of probes.csv, "
                            "or take it away.",
                            entry.path().string()));
        LoadState& shown = set_.states[found->second];
        if (!shown.field.empty())
            throw InvalidInput(fmt::format("{}: {} is a field of the same state. Keep one.", entry.path().string(),
                                           shown.field.filename().string()));
        shown.field = entry.path();
        shown.field_unit = units_.length;
    }
}

void TableReader::read_markers(const fs::path& file) {
    const CsvTable table(file, {"marker", "x", "y", "z"}, {"ax", "ay", "az"});
    for (int row = 0; row < table.rows(); ++row) {
        Marker marker;
        marker.id = table.integer(row, "marker");
        marker.rest = units_.length * vector(table, row, {"x", "y", "z"});
        const Vec3 anchor = units_.length * vector_if_given(table, row, {"ax", "ay", "az"});
        if (anchor.allFinite()) marker.anchor = anchor;
        if (!marker.anchor && !anchor.array().isNaN().all())
            throw InvalidInput(
                fmt::format("{}: marker {} has half an anchor. Give ax, ay and az, or leave all three empty.",
                            table.where(row), marker.id));
        if (!marker_of_.try_emplace(marker.id, static_cast<int>(set_.markers.size())).second)
            throw InvalidInput(fmt::format("{}: marker {} has a row already. Give each marker its own number.",
                                           table.where(row), marker.id));
        set_.markers.push_back(marker);
    }
}

Reading TableReader::read_position(const CsvTable& table, int row) const {
    Reading reading{.position = units_.length * vector_if_given(table, row, {"x", "y", "z"}),
                    .sigma = units_.length * table.at(row, "sigma")};
    if (reading.sigma <= 0)
        throw InvalidInput(fmt::format("{}, column sigma: {} must be above 0. Leave it empty where it is unknown.",
                                       table.where(row), table.at(row, "sigma")));
    if (std::isnan(table.at(row, "marker"))) return reading;
    const int id = table.integer(row, "marker");
    const auto found = marker_of_.find(id);
    if (found == marker_of_.end())
        throw InvalidInput(
            fmt::format("{}: marker {} is not in markers.csv. Add its rest position there, or leave the cell "
                        "empty for an unlabelled reading.",
                        table.where(row), id));
    reading.marker = found->second;
    return reading;
}

void TableReader::read_positions(const fs::path& file) {
    const CsvTable table(file, {"probe", "time", "marker", "x", "y", "z"}, {"sigma"});
    std::set<std::pair<std::size_t, int>> seen;  // state, marker
    for (int row = 0; row < table.rows(); ++row) {
        const StateKey key = state_key(table, row);
        const auto found = index_of_.find(key);
        if (found == index_of_.end())
            throw InvalidInput(
                fmt::format("{}: there is no state of probe {} at time {}. Add its row to probes.csv (with "
                            "zero force when nothing pressed), or correct the numbers.",
                            table.where(row), key.first, key.second));
        const Reading reading = read_position(table, row);
        if (reading.marker >= 0 && !seen.emplace(found->second, reading.marker).second)
            throw InvalidInput(fmt::format(
                "{}: marker {} was read already for probe {} at time {}. Keep one reading, or "
                "give repeated measurements probes of their own.",
                table.where(row), set_.markers[static_cast<std::size_t>(reading.marker)].id, key.first, key.second));
        const bool nothing_seen = reading.position.array().isNaN().all();
        if (!nothing_seen) set_.states[found->second].readings.push_back(reading);
    }
}

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
    check_places(set);
    return set;
}

}  // namespace palpate::identify
