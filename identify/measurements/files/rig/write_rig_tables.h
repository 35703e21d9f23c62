#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// motions.csv, reactions.csv, actuations.csv and displacements.csv of a set, in mm, N, MPa, rad; those that would have
/// no row are not written. @throws IoError.
void write_rig_tables(const std::filesystem::path& folder, const MeasurementSet& set);

/// The state that the set's displacements count from; none where it has no differences.
/// @throws InvalidInput where they count from several, which one file cannot tell.
std::optional<StateName> displacements_since(const MeasurementSet& set);

/// A number of a table as it is read back; empty for NaN.
std::string table_cell(double value);
std::string table_cells(const Vec3& v);
/// A name, in quotes where it holds what means something in a table.
std::string table_name(const std::string& name);

}  // namespace palpate::identify
