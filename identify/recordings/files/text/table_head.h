#pragma once

#include <vector>

#include "identify/recordings/files/text/decoding/text_file.h"
#include "mesh/errors.h"

namespace palpate::identify {

/// The first row and what stands above it.
struct TableHead {
    int first_row = 0;           // all of them counted from 0
    int names = -1, units = -1;  // -1: there is none
    int groups = -1;             // names above names: "Tip,,,Base,," above "x,y,z,x,y,z"
};

/// Which lines are a table's: where it begins, how many cells a row has, and which lines name them.
struct TableLines {
    TableHead head;
    std::vector<int> rows;      // from 0, those with numbers, in their order
    int width = 0;              // cells of a row
    std::vector<int> others{};  // where other tables begin, which are left out
};

/// There is no row of numbers in a text.
struct NoTable : InvalidInput {
    using InvalidInput::InvalidInput;
};

/// @throws NoTable; InvalidInput where the table goes on after a line that is no row.
TableLines find_table(const TextFile& text, const FileMap& map);

/// The cells of a line of names or units: without the sign of a comment, and cut at two blanks where cutting at one
/// gives too many.
std::vector<std::string_view> header_cells(const TextFile& text, int line, int width);

}  // namespace palpate::identify
