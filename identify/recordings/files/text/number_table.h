#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/recordings/files/text/decoding/text_file.h"

namespace palpate::identify {

/// A column of a table of numbers; one whose cells are mostly no numbers is one of texts.
struct NumberColumn {
    std::string name;  // "": the file names none
    std::string unit;  // as the file tells it; "": it does not
    bool is_text = false;
    Eigen::VectorXd values;          // (rows); NaN where a cell is missing, and all over in a column of texts
    std::vector<std::string> texts;  // (rows) of a column of texts
};

/// The longest run of rows of numbers in a text, with the names and units that stand above it.
struct NumberTable {
    std::vector<NumberColumn> columns;
    std::vector<int> lines;  // of the file, from 0, behind each row
    bool has_names = false;
    std::string preamble;            // what stands above, in lower case
    std::vector<std::string> notes;  // what was found, in words

    Eigen::Index rows() const { return static_cast<Eigen::Index>(lines.size()); }
};

/// @throws InvalidInput where there is no row of numbers, a row has too many cells, a cell in a column of numbers is a
/// date or a text, or the table goes on after a line that is no row.
NumberTable read_number_table(const TextFile& text, const FileMap& map);

/// The index of the column that a map names, by name or by number from 1. @throws InvalidInput where there is none, or
/// several have that name.
int column_of(const NumberTable& table, const std::string& column, const std::string& file);

}  // namespace palpate::identify
