#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "identify/measurements/files/set_units.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/text/csv_table.h"

namespace palpate::identify {

/// Fills markers and states of a set, table by table.
class TableReader {
public:
    TableReader(MeasurementSet& set, const SetUnits& units) : set_(set), units_(units) {}

    // What acted: their rows make the states.
    void read_probes(const std::filesystem::path& file);
    void read_states(const std::filesystem::path& file);
    void read_motions(const std::filesystem::path& file);
    void read_actuations(const std::filesystem::path& file);
    /// Where several tables have made them: probe by probe, each in the order of time.
    /// @throws InvalidInput where one body went through all of them, and the order is nowhere told.
    void order_states();

    // What was read. @pre the states are there, and for readings of markers these.
    void find_fields(const std::filesystem::path& folder);
    void read_markers(const std::filesystem::path& file);
    void read_positions(const std::filesystem::path& file);
    /// @param since the state that they count from; none: rest, and they are positions
    void read_displacements(const std::filesystem::path& file, const std::optional<StateName>& since);
    void read_reactions(const std::filesystem::path& file);
    /// What acted on a body in motion, and what was read meanwhile. @pre the markers are read.
    void read_recordings(const std::filesystem::path& loads, const std::filesystem::path& readings);

private:
    /// The state of a row's name, made where it is new.
    LoadState& state(const StateName& name, const mesh::CsvTable& table, int row);
    /// @throws InvalidInput where no table of what acted has such a row.
    std::size_t known_state(const mesh::CsvTable& table, int row) const;
    /// @throws InvalidInput where time is negative, or runs backwards within a probe.
    void check_time(const StateName& name, const std::string& where);
    /// @throws InvalidInput where the header of one of these columns tells another unit of length than set.yaml.
    void require_length(const mesh::CsvTable& table, const std::vector<std::string>& columns) const;
    /// The marker of a row, or -1 where its cell is empty.
    int marker_of_row(const mesh::CsvTable& table, int row) const;
    /// @throws InvalidInput where a state has a reading of this marker already.
    void check_single(std::size_t state, int marker, const std::string& where);
    double position_sigma(const mesh::CsvTable& table, int row) const;
    Reading read_position(const mesh::CsvTable& table, int row) const;
    /// @throws InvalidInput where the reading has no marker, its probe no load, or time runs backwards.
    void add_to_recording(const mesh::CsvTable& table, int row, const std::map<int, std::size_t>& recording_of);

    MeasurementSet& set_;
    const SetUnits& units_;
    std::map<StateName, std::size_t> index_of_;   // of the states
    std::map<int, double> last_time_;             // of each probe, so far
    std::map<std::string, int> marker_of_;        // id in the files -> index
    std::set<std::pair<std::size_t, int>> seen_;  // state and marker of the positions that were read
    std::string first_table_;                     // that has made states
    std::string beyond_;                          // where another one has made one first; "": none has
};

/// Probe and time of a row.
StateName state_name(const mesh::CsvTable& table, int row);

/// @throws InvalidInput where a time is negative.
void check_not_negative(double time, const std::string& where);

/// 1 sigma of a row, in its unit; NaN where it is not told. @throws InvalidInput where it is below `least`.
double told_sigma(const mesh::CsvTable& table, int row, double least);

/// Three cells, each NaN where it is empty or its column absent.
Vec3 vector_if_given(const mesh::CsvTable& table, int row, const std::array<std::string, 3>& columns);

}  // namespace palpate::identify
