#include "identify/measurements/files/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {

namespace fs = std::filesystem;
using mesh::CsvTable;

namespace {

Vec3 vector(const CsvTable& table, int row, const std::array<std::string, 3>& columns) {
    return {table.number(row, columns[0]), table.number(row, columns[1]), table.number(row, columns[2])};
}

/// "7" for a cell that spreadsheets may have made "7.0"; a word as it is.
std::string marker_key(const std::string& cell) {
    const auto number = mesh::parse_number(cell);
    constexpr double most = std::numeric_limits<int>::max();
    const bool is_whole = number && *number == std::floor(*number) && std::abs(*number) <= most;
    return is_whole ? std::to_string(static_cast<int>(*number)) : cell;
}

}  // namespace

StateName state_name(const CsvTable& table, int row) {
    return {table.integer(row, "probe"), table.number(row, "time")};
}

void check_not_negative(double time, const std::string& where) {
    if (time < 0)
        throw InvalidInput(fmt::format(
            "{}, column time: {} is negative. Count time from the beginning of the probe, which is 0.", where, time));
}

double told_sigma(const CsvTable& table, int row, double least) {
    const double sigma = table.at(row, "sigma");
    if (sigma < least)
        throw InvalidInput(
            fmt::format("{}, column sigma: {} is below {:g}, less than any instrument's noise. Leave it empty where it "
                        "is unknown.",
                        table.where(row), sigma, least));
    return sigma;
}

Vec3 vector_if_given(const CsvTable& table, int row, const std::array<std::string, 3>& columns) {
    return {table.at(row, columns[0]), table.at(row, columns[1]), table.at(row, columns[2])};
}

LoadState& TableReader::state(const StateName& name, const CsvTable& table, int row) {
    const auto [entry, is_new] = index_of_.try_emplace(name, set_.states.size());
    if (is_new) {
        LoadState& added = set_.states.emplace_back();
        added.probe = name.probe;
        added.time = name.time;
        const std::string where = table.where(row), file = where.substr(0, where.find(','));
        if (first_table_.empty()) first_table_ = file;
        if (file != first_table_ && beyond_.empty()) beyond_ = where;
    }
    return set_.states[entry->second];
}

void TableReader::check_time(const StateName& name, const std::string& where) {
    const auto [probe, time] = name;
    check_not_negative(time, where);
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
    require_length(table, {"x", "y", "z", "radius"});
    table.require_unit({"fx", "fy", "fz"}, units_.force_name, "set.yaml");
    for (int row = 0; row < table.rows(); ++row) {
        const StateName name = state_name(table, row);
        check_time(name, table.where(row));
        LoadState& loaded = state(name, table, row);
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
    std::set<StateName> seen;
    for (int row = 0; row < table.rows(); ++row) {
        const StateName name = state_name(table, row);
        if (!seen.insert(name).second)
            throw InvalidInput(fmt::format("{}: probe {} at time {} has a row already. Keep one.", table.where(row),
                                           name.probe, name.time));
        LoadState& known = state(name, table, row);
        known.pressure = units_.pressure * table.at(row, "pressure");
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
    const CsvTable table(file, {"marker", "x", "y", "z"}, {"ax", "ay", "az"}, {"marker"});
    require_length(table, {"x", "y", "z", "ax", "ay", "az"});
    bool are_numbers = true;
    for (int row = 0; row < table.rows(); ++row)
        are_numbers = are_numbers && mesh::parse_integer(marker_key(table.name(row, "marker"))).has_value();
    for (int row = 0; row < table.rows(); ++row) {
        Marker marker;
        const std::string key = marker_key(table.name(row, "marker"));
        marker.id = are_numbers ? *mesh::parse_integer(key) : row + 1;
        if (!are_numbers) marker.name = key;
        marker.rest = units_.length * vector(table, row, {"x", "y", "z"});
        const Vec3 anchor = units_.length * vector_if_given(table, row, {"ax", "ay", "az"});
        if (anchor.allFinite()) marker.anchor = anchor;
        if (!marker.anchor && !anchor.array().isNaN().all())
            throw InvalidInput(
                fmt::format("{}: marker {} has half an anchor. Give ax, ay and az, or leave all three empty.",
                            table.where(row), key));
        if (!marker_of_.try_emplace(key, static_cast<int>(set_.markers.size())).second)
            throw InvalidInput(fmt::format("{}: marker {} has a row already. Give each marker its own {}.",
                                           table.where(row), key, are_numbers ? "number" : "name"));
        set_.markers.push_back(marker);
    }
}

std::size_t TableReader::known_state(const CsvTable& table, int row) const {
    const StateName name = state_name(table, row);
    const auto found = index_of_.find(name);
    if (found == index_of_.end())
        throw InvalidInput(
            fmt::format("{}: there is no state of probe {} at time {}. Add its row to probes.csv (with "
                        "zero force when nothing pressed), or correct the numbers.",
                        table.where(row), name.probe, name.time));
    return found->second;
}

int TableReader::marker_of_row(const CsvTable& table, int row) const {
    const std::string key = marker_key(table.text(row, "marker"));
    if (key.empty()) return -1;
    const auto found = marker_of_.find(key);
    if (found != marker_of_.end()) return found->second;
    std::vector<std::string> known;
    std::ranges::transform(set_.markers, std::back_inserter(known), label_of);
    throw InvalidInput(fmt::format(
        "{}: marker {} is not in markers.csv{}. Add its rest position there, or leave the cell empty for an "
        "unlabelled reading.",
        table.where(row), key, mesh::parse_integer(key) ? "" : mesh::suggestion(key, known)));
}

void TableReader::require_length(const CsvTable& table, const std::vector<std::string>& columns) const {
    table.require_unit(columns, units_.length_name, "set.yaml");
}

double TableReader::position_sigma(const CsvTable& table, int row) const {
    return units_.length * told_sigma(table, row, least_position_noise / units_.length);
}

Reading TableReader::read_position(const CsvTable& table, int row) const {
    const double sigma = position_sigma(table, row);
    return {.marker = marker_of_row(table, row),
            .position = units_.length * vector_if_given(table, row, {"x", "y", "z"}),
            .sigma = sigma};
}

void TableReader::check_single(std::size_t state, int marker, const std::string& where) {
    if (!seen_.emplace(state, marker).second)
        throw InvalidInput(
            fmt::format("{}: marker {} was read already for probe {} at time {}. Keep one reading, or "
                        "give repeated measurements probes of their own.",
                        where, label_of(set_.markers[static_cast<std::size_t>(marker)]), set_.states[state].probe,
                        set_.states[state].time));
}

void TableReader::read_positions(const fs::path& file) {
    const CsvTable table(file, {"probe", "time", "marker", "x", "y", "z"}, {"sigma"}, {"marker"});
    require_length(table, {"x", "y", "z", "sigma"});
    for (int row = 0; row < table.rows(); ++row) {
        const std::size_t state = known_state(table, row);
        const Reading reading = read_position(table, row);
        if (reading.marker >= 0) check_single(state, reading.marker, table.where(row));
        const bool nothing_seen = reading.position.array().isNaN().all();
        if (!nothing_seen) set_.states[state].readings.push_back(reading);
    }
}

void TableReader::add_to_recording(const CsvTable& table, int row, const std::map<int, std::size_t>& recording_of) {
    const auto [probe, time] = state_name(table, row);
    const auto found = recording_of.find(probe);
    if (found == recording_of.end())
        throw InvalidInput(
            fmt::format("{}: probe {} has no row in motion_probes.csv. Tell there what acted on the body (zero "
                        "force when nothing did).",
                        table.where(row), probe));
    const Reading reading = read_position(table, row);
    if (reading.marker < 0)
        throw InvalidInput(
            fmt::format("{}: a reading of a body in motion has no marker. Give its number or name.", table.where(row)));
    std::vector<MotionRecording::Instant>& instants = set_.recordings[found->second].instants;
    if (time < 0 || (!instants.empty() && time < instants.back().time))
        throw InvalidInput(
            fmt::format("{}, column time: {} comes after {} in probe {}. Count time from the beginning of the probe, "
                        "which is 0, and put its rows in the order in which they happened.",
                        table.where(row), time, instants.empty() ? 0.0 : instants.back().time, probe));
    if (instants.empty() || time > instants.back().time) instants.push_back({.time = time, .readings = {}});
    std::vector<Reading>& seen = instants.back().readings;
    if (std::ranges::find(seen, reading.marker, &Reading::marker) != seen.end())
        throw InvalidInput(fmt::format("{}: marker {} was read already for probe {} at time {}. Keep one reading.",
                                       table.where(row), table.text(row, "marker"), probe, time));
    if (!reading.position.array().isNaN().all()) seen.push_back(reading);
}

void TableReader::read_recordings(const fs::path& loads, const fs::path& readings) {
    MeasurementSet moved;
    TableReader(moved, units_).read_probes(loads);
    std::map<int, std::size_t> recording_of;
    for (LoadState& load : moved.states) {
        const auto [entry, is_new] = recording_of.try_emplace(load.probe, set_.recordings.size());
        if (is_new) set_.recordings.push_back({.probe = load.probe, .loads = {}, .instants = {}});
        set_.recordings[entry->second].loads.push_back(std::move(load));
    }
    const CsvTable table(readings, {"probe", "time", "marker", "x", "y", "z"}, {"sigma"}, {"marker"});
    require_length(table, {"x", "y", "z", "sigma"});
    for (int row = 0; row < table.rows(); ++row) add_to_recording(table, row, recording_of);
    for (const MotionRecording& recording : set_.recordings) {
        if (recording.instants.empty())
            throw InvalidInput(
                fmt::format("{}: probe {} of motion_probes.csv has no readings. Add them, or take it "
                            "away there.",
                            readings.string(), recording.probe));
    }
}

}  // namespace palpate::identify
