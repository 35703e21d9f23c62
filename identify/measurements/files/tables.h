#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "identify/measurements/files/set_description.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/text/csv_table.h"

namespace palpate::identify {

/// What identifies a state in every table.
using StateKey = std::pair<int, double>;  // probe, time

/// Fills markers and states of a set, table by table.
class TableReader {
public:
    TableReader(MeasurementSet& set, const SetUnits& units) : set_(set), units_(units) {}

    void read_probes(const std::filesystem::path& file);
    void read_states(const std::filesystem::path& file);
    void find_fields(const std::filesystem::path& folder);
    void read_markers(const std::filesystem::path& file);
    void read_positions(const std::filesystem::path& file);
    /// What acted on a body in motion, and what was read meanwhile. @pre the markers are read.
    void read_recordings(const std::filesystem::path& loads, const std::filesystem::path& readings);

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
    Reading read_position(const mesh::CsvTable& table, int row) const;
    /// @throws InvalidInput where the reading has no marker, its probe no load, or time runs backwards.
    void add_to_recording(const mesh::CsvTable& table, int row, const std::map<int, std::size_t>& recording_of);

    MeasurementSet& set_;
    const SetUnits& units_;
    std::map<StateKey, std::size_t> index_of_;  // of the states
    std::map<int, double> last_time_;           // of each probe, so far
    std::map<int, int> marker_of_;              // id in the files -> index
};

}  // namespace palpate::identify
