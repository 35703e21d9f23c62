#include "identify/recordings/files/text/number_rows.h"

#include <fmt/format.h>

#include <limits>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {

NumberRows read_number_rows(const TextFile& text, int first, int end, const std::vector<std::string>& columns,
                            const std::vector<char>& are_texts) {
    NumberRows rows;
    const std::size_t width = columns.size();
    std::size_t cells_there = 0;
    for (int i = first; i < end; ++i) {
        if (trimmed(text.line(i)).empty()) continue;
        auto cells = text.cells(i);
        while (!cells.empty() && cells.back().empty()) cells.pop_back();
        if (cells.empty()) continue;
        if (cells.size() > width)
            throw InvalidInput(
                fmt::format("{}: {} cells where {} columns are named. Remove what is too much, or export the "
                            "file again.",
                            text.where(i), cells.size(), width));
        cells_there += cells.size();
        rows.lines.push_back(i);
    }
    // What is left out costs memory: not much of it is believed.
    constexpr std::size_t most_missing = 1000;  // for each cell that is there
    if (rows.lines.size() * width > most_missing * (cells_there + 1000))
        throw InvalidInput(fmt::format("{}: {} columns are named, but its rows have hardly any cells. Export it again.",
                                       text.file().filename().string(), width));
    rows.values.setConstant(static_cast<Eigen::Index>(rows.lines.size()), static_cast<Eigen::Index>(width),
                            std::numeric_limits<double>::quiet_NaN());
    for (std::size_t r = 0; r < rows.lines.size(); ++r) {
        const auto cells = text.cells(rows.lines[r]);
        for (std::size_t c = 0; c < std::min(cells.size(), width); ++c) {
            if (c < are_texts.size() && are_texts[c]) continue;
            const CellValue cell = value_of(cells[c], text.dialect());
            if (cell.kind == CellValue::Kind::number)
                rows.values(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = cell.value;
            else if (cell.kind != CellValue::Kind::missing)
                refuse_cell(text, rows.lines[r], columns[c].empty() ? fmt::format("{}", c + 1) : columns[c], cells[c]);
        }
    }
    return rows;
}

void refuse_cell(const TextFile& text, int line, const std::string& column, std::string_view cell) {
    const bool is_date = value_of(cell, text.dialect()).kind == CellValue::Kind::date;
    throw InvalidInput(fmt::format(
        "{}, column {}: {} is {}. {}", text.where(line), mesh::cited(column), mesh::cited(cell),
        is_date ? "a date, where numbers are needed" : "no number",
        is_date ? "A spreadsheet takes numbers for dates: format the column as numbers and write the file again."
                : "Numbers are written as 12.5, 12,5 or 1.25e1; leave a cell empty where a value is missing."));
}

}  // namespace palpate::identify
