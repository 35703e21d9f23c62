#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/files/text/number_table.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// A table of numbers: with a row for each instant, or one for each point (and instant), by the map or by its names.
/// @throws InvalidInput, IoError where the map names another file that is not there.
Recording read_table(const TextFile& text, const FileMap& map);

/// A table with a row for each instant.
Recording rows_of_instants(const NumberTable& table, const TextFile& text, const FileMap& map);

/// The columns of a table with a row for each point: exports of image correlation, scans, markers.
struct PointRowColumns {
    int point = -1, frame = -1, time = -1;  // -1: there is none
    std::array<int, 3> at{-1, -1, -1};
    std::array<int, 3> displacement{-1, -1, -1};
    int quality = -1;                    // negative where a point was not found
    std::string format;                  // whose names these are, in words
    bool are_moved = false;              // coordinates are where points stand now, not where they rest
    std::string unit = {};               // of coordinates, as the lines above tell it
    std::optional<double> instant = {};  // of the only instant, likewise [s]
};

/// None where the table has a row for each instant.
std::optional<PointRowColumns> point_rows_in(const NumberTable& table, const TextFile& text, const FileMap& map);

/// @throws InvalidInput where a point comes twice in a frame, or frames have different points that have no names.
Recording rows_of_points(const NumberTable& table, const PointRowColumns& columns, const TextFile& text,
                         const FileMap& map);

/// Points in matrices, by the map's `sheets`. @throws InvalidInput where their sizes do not fit; IoError.
Recording read_sheets(const std::filesystem::path& file, const FileMap& map);

}  // namespace palpate::identify
