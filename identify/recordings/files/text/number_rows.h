#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/recordings/files/text/decoding/text_file.h"

namespace palpate::identify {

/// Rows of numbers of a known width.
struct NumberRows {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> values;  // (rows x width); NaN where missing
    std::vector<int> lines;  // of the file, from 0, behind each row
};

/// Those in lines `first` to `end` - 1; blank lines are skipped, cells that are missing at the end of a row may be left
/// out. @param columns their names, for messages; their number is the width
/// @param are_texts which columns are left out; may be empty
/// @throws InvalidInput naming the cell that is no number, or the line that has too many.
NumberRows read_number_rows(const TextFile& text, int first, int end, const std::vector<std::string>& columns,
                            const std::vector<char>& are_texts = {});

/// @throws InvalidInput naming line and column of a cell that is no number.
[[noreturn]] void refuse_cell(const TextFile& text, int line, const std::string& column, std::string_view cell);

}  // namespace palpate::identify
