#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mesh/formats/yaml/yaml_fields.h"

namespace palpate::identify {

/// Where a column of numbers stands.
struct ColumnPlace {
    std::string column;  ///< its name in the header, or its number from 1
    std::string file;    ///< another file in the same folder, with as many rows; "": the file that the map is for
};

/// A point whose coordinates a table holds in columns.
struct MappedPoint {
    std::string name;
    std::vector<ColumnPlace> at;            ///< x, y and z; of a point in a plane x and y
    std::vector<ColumnPlace> displacement;  ///< likewise; empty: the table tells positions only
};

/// A sampled quantity that a table holds in a column.
struct MappedChannel {
    ColumnPlace place;
    std::string name;  ///< "": as the header names it
    std::string unit;  ///< that its cells are in; "": as the header tells it
};

/// Points in matrices without a header, one file a coordinate: a row a point, a column a frame, or the other way round.
struct MappedSheets {
    std::vector<std::string> at;    ///< files of x, y and, where there is one, z
    std::vector<std::string> rest;  ///< the same of one frame before the first; may be empty
    bool frames_in_rows = false;    ///< otherwise they are in columns
};

/// What map.yaml tells of one file: what the file cannot say about itself, or says wrongly. Whatever is not told is
/// found out where it can be.
struct FileMap {
    /// One of `format_names`; empty: by the file's content.
    std::string format;

    // How a text is written.
    std::optional<std::string> encoding;  ///< "utf-8", "utf-16" or "latin-1"
    std::optional<char> delimiter;        ///< ',', ';', '\t' or ' ' (any number of blanks)
    std::optional<char> decimal;          ///< '.' or ','
    std::optional<int> header_lines;      ///< lines before the first row of numbers
    std::optional<int> names_line;        ///< the one of them that names the columns, from 1; 0: none does

    // Its clock: the column of times, or a rate where there is none.
    std::optional<ColumnPlace> time;
    std::string time_unit;       ///< "s", "ms", "us" or "min"; "": as the file tells it, or s
    std::optional<double> rate;  ///< of frames [1/s]; goes before the file's own

    // Its positions.
    std::string unit;                ///< "mm", "cm", "m", "um", "in" or "pixel"; "": as the file tells it, or mm
    double pixel = 0;                ///< size of a pixel [mm], where the unit is pixel
    std::vector<std::string> names;  ///< of the points in their order; empty: as the file names them

    // Columns of a table.
    std::vector<MappedPoint> points;
    std::vector<MappedChannel> channels;  ///< goes before what the header tells; where none is told, all that are left
    /// Of tables with a row for each point (and frame): the columns that tell the point and the frame.
    std::optional<ColumnPlace> point_column, frame_column;
    std::optional<MappedSheets> sheets;

    /// The file is one of a series that is numbered in its name: each is a frame, and all of them are read.
    bool series = false;
};

/// What `format` may say.
inline const std::vector<std::string> format_names{"c3d", "trc",    "motive", "vicon", "machine", "dic",
                                                   "mat", "exodus", "scan",   "table", "sheets"};

/// Reads one entry of `files` in a map.yaml, all but its `file` (which file, or pattern of names, it is for) and what
/// the caller reads further, who then finishes it. @throws InvalidInput.
FileMap read_file_map(const mesh::YamlFields& entry);

}  // namespace palpate::identify
