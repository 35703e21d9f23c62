#include "identify/recordings/files/text/number_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "identify/recordings/files/text/number_rows.h"
#include "identify/recordings/files/text/table_head.h"
#include "identify/recordings/files/units.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A group's name stands before those of its columns; an empty cell goes on with the group before.
void prefix_groups(const TextFile& text, const TableLines& lines, NumberTable& table) {
    const auto groups = header_cells(text, lines.head.groups, lines.width);
    std::string_view group;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        if (c < groups.size() && !groups[c].empty()) group = groups[c];
        std::string& name = table.columns[c].name;
        if (!group.empty() && !name.empty()) name = fmt::format("{} {}", group, name);
    }
    table.notes.push_back(fmt::format("line {} names groups of columns", lines.head.groups + 1));
}

void name_columns(const TextFile& text, const TableLines& lines, NumberTable& table) {
    if (lines.head.names >= 0) {
        const auto names = header_cells(text, lines.head.names, lines.width);
        if (names.size() > table.columns.size()) {
            table.notes.push_back(fmt::format("line {} has {} names for {} columns: they are left out",
                                              lines.head.names + 1, names.size(), table.columns.size()));
        } else {
            table.has_names = true;
            for (std::size_t c = 0; c < names.size(); ++c) {
                const NameAndUnit told = name_and_unit(names[c]);
                table.columns[c].name = told.name;
                table.columns[c].unit = told.unit;
            }
            if (lines.head.groups >= 0) prefix_groups(text, lines, table);
            table.notes.push_back(fmt::format("line {} names the columns", lines.head.names + 1));
        }
    } else {
        table.notes.emplace_back("no line names the columns");
    }
    if (lines.head.units >= 0) {
        const auto units = header_cells(text, lines.head.units, lines.width);
        for (std::size_t c = 0; c < std::min(units.size(), table.columns.size()); ++c) {
            std::string_view unit = units[c];
            if (unit.size() >= 2 && (unit.front() == '(' || unit.front() == '['))
                unit = trimmed(unit.substr(1, unit.size() - 2));
            if (!unit.empty()) table.columns[c].unit = unit;
        }
        table.notes.push_back(fmt::format("line {} tells units", lines.head.units + 1));
    }
}

/// Columns that hold nothing at the end: lines end with a delimiter.
void drop_empty_end(NumberTable& table) {
    while (table.columns.size() > 1 && !table.columns.back().is_text && table.columns.back().name.empty() &&
           table.columns.back().values.array().isNaN().all())
        table.columns.pop_back();
}

}  // namespace

NumberTable read_number_table(const TextFile& text, const FileMap& map) {
    const TableLines lines = find_table(text, map);
    NumberTable table;
    table.notes = text.notes();
    table.columns.resize(static_cast<std::size_t>(lines.width));
    table.lines = lines.rows;
    for (int i = 0; i < lines.head.first_row; ++i) table.preamble += lower_case(text.line(i)) + "\n";
    name_columns(text, lines, table);
    const Eigen::Index rows = table.rows();
    if (rows == 0) return table;

    // What each column holds mostly.
    std::vector<int> numbers(table.columns.size()), others(table.columns.size());
    for (const int line : lines.rows) {
        const auto cells = text.cells(line);
        for (std::size_t c = 0; c < std::min(cells.size(), numbers.size()); ++c) {
            const auto kind = value_of(cells[c], text.dialect()).kind;
            if (kind == CellValue::Kind::number) ++numbers[c];
            if (kind == CellValue::Kind::date || kind == CellValue::Kind::text) ++others[c];
        }
    }
    for (std::size_t c = 0; c < numbers.size(); ++c) {
        NumberColumn& column = table.columns[c];
        column.is_text = others[c] > numbers[c];
        column.values = Eigen::VectorXd::Constant(rows, nan);
        if (column.is_text) column.texts.resize(static_cast<std::size_t>(rows));
    }
    for (Eigen::Index r = 0; r < rows; ++r) {
        const int line = lines.rows[static_cast<std::size_t>(r)];
        const auto cells = text.cells(line);
        for (std::size_t c = 0; c < std::min(cells.size(), table.columns.size()); ++c) {
            NumberColumn& column = table.columns[c];
            if (column.is_text) {
                column.texts[static_cast<std::size_t>(r)] = cells[c];
                continue;
            }
            const CellValue cell = value_of(cells[c], text.dialect());
            if (cell.kind == CellValue::Kind::number)
                column.values[r] = cell.value;
            else if (cell.kind != CellValue::Kind::missing)
                refuse_cell(text, line, column.name.empty() ? fmt::format("{}", c + 1) : column.name, cells[c]);
        }
    }
    drop_empty_end(table);
    if (!lines.others.empty())
        table.notes.push_back(
            fmt::format("{} more table{} of numbers left out (line {}): 'header_lines' tells where another one begins",
                        lines.others.size(), lines.others.size() == 1 ? "" : "s", lines.others.front() + 1));
    const int last = lines.rows.back();
    table.notes.push_back(fmt::format("rows in lines {} to {}", lines.head.first_row + 1, last + 1));
    return table;
}

int column_of(const NumberTable& table, const std::string& column, const std::string& file) {
    std::vector<std::string> names;
    int found = -1, count = 0;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        const std::string& name = table.columns[c].name;
        if (!name.empty()) names.push_back(name);
        if (lower_case(name) != lower_case(trimmed(column)) || name.empty()) continue;
        found = static_cast<int>(c);
        ++count;
    }
    if (count == 1) return found;
    if (count > 1)
        throw InvalidInput(fmt::format("{}: {} columns are named {}. Give the column's number in the map.", file, count,
                                       mesh::cited(column)));
    if (const auto number = mesh::parse_integer(trimmed(column))) {
        if (*number >= 1 && *number <= static_cast<int>(table.columns.size())) return *number - 1;
        throw InvalidInput(
            fmt::format("{}: there is no column {}; 1 to {} are allowed.", file, *number, table.columns.size()));
    }
    constexpr std::size_t most_names = 20;  // in a message
    if (names.size() > most_names) names.resize(most_names);
    throw InvalidInput(fmt::format("{}: no column is named {}{}. {}", file, mesh::cited(column),
                                   mesh::suggestion(column, names),
                                   names.empty() ? "The file names none: give its number, from 1."
                                                 : "There are " + mesh::listed(names) + ", or a number from 1."));
}

}  // namespace palpate::identify
