#include "mesh/text/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"

namespace palpate::mesh {

namespace {

std::string_view without_spaces(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The cells of a line; in a cell in double quotes neither ',' nor '#' means anything.
std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> cells;
    bool in_quotes = false;
    std::size_t start = 0;
    const auto close_cell = [&](std::size_t end) {
        std::string_view cell = without_spaces(line.substr(start, end - start));
        if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
            cell = without_spaces(cell.substr(1, cell.size() - 2));
        cells.push_back(cell);
        start = end + 1;
    };
    std::size_t i = 0;
    for (; i < line.size() && (in_quotes || line[i] != '#'); ++i) {
        if (line[i] == '"') in_quotes = !in_quotes;
        if (line[i] == ',' && !in_quotes) close_cell(i);
    }
    close_cell(i);
    const bool blank = cells.size() == 1 && cells.front().empty();
    return blank ? std::vector<std::string_view>{} : cells;
}

void check_columns(const std::vector<std::string>& columns, const std::string& where,
                   const std::vector<std::string>& required, const std::vector<std::string>& optional) {
    std::vector<std::string> known = required;
    known.insert(known.end(), optional.begin(), optional.end());
    const std::string allowed = fmt::format("required: {}{}{}", fmt::join(required, ","),
                                            optional.empty() ? "" : "; optional: ", fmt::join(optional, ","));
    if (columns.size() == 1 && required.size() > 1 && columns[0].find_first_of(";\t") != std::string::npos)
        throw InvalidInput(fmt::format("{}: the header {} holds no comma. Separate the cells by commas ({}).", where,
                                       cited(columns[0]), allowed));
    for (const auto& column : columns) {
        if (std::ranges::count(columns, column) > 1)
            throw InvalidInput(fmt::format("{}: the column {} is named twice. Name each once.", where, cited(column)));
        if (std::ranges::find(known, column) == known.end())
            throw InvalidInput(fmt::format("{}: unknown column {}{}. Columns are {}. Is the first line a header?",
                                           where, cited(column), suggestion(column, known), allowed));
    }
    for (const auto& column : required)
        if (std::ranges::find(columns, column) == columns.end())
            throw InvalidInput(fmt::format("{}: the column '{}' is missing. Columns are {}.", where, column, allowed));
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file, const std::vector<std::string>& required,
                   const std::vector<std::string>& optional, const std::vector<std::string>& names)
    : file_(file) {
    const std::string text = read_text(file);
    std::string_view rest = text;
    require_utf8(text, file.filename().string());
    if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);

    std::vector<char> is_name;  // of each column
    for (int line = 1; !rest.empty(); ++line) {
        const auto end = std::min(rest.find('\n'), rest.size());
        const auto cells = split(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (cells.empty()) continue;

        const std::string here = fmt::format("{}, line {}", file.filename().string(), line);
        if (columns_.empty()) {
            columns_.assign(cells.begin(), cells.end());
            check_columns(columns_, here, required, optional);
            for (const auto& column : columns_) is_name.push_back(std::ranges::count(names, column) > 0);
            continue;
        }
        if (cells.size() != columns_.size())
            throw InvalidInput(
                fmt::format("{}: {} cells where the header has {} ({}). Give every cell, empty if need be.", here,
                            cells.size(), columns_.size(), fmt::join(columns_, ",")));
        std::vector<double> row;
        row.reserve(cells.size());
        std::vector<std::string> named(names.empty() ? 0 : cells.size());
        for (std::size_t c = 0; c < cells.size(); ++c) {
            if (is_name[c]) {
                named[c] = cells[c];
                row.push_back(std::numeric_limits<double>::quiet_NaN());
                continue;
            }
            const auto value = parse_number(cells[c]);
            if (!value && !cells[c].empty())
                throw InvalidInput(
                    fmt::format("{}, column {}: {} is no number. Write finite numbers as 12.5 or 1.25e1, "
                                "or leave the cell empty where a value is missing.",
                                here, columns_[c], cited(cells[c])));
            row.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
        }
        lines_.push_back(line);
        cells_.push_back(std::move(row));
        text_.push_back(std::move(named));
    }
    if (columns_.empty())
        throw InvalidInput(fmt::format("{}: the file is empty. Its first line names the columns: {}.",
                                       file.filename().string(), fmt::join(required, ",")));
}

bool CsvTable::has(const std::string& column) const { return std::ranges::find(columns_, column) != columns_.end(); }

double CsvTable::at(int row, const std::string& column) const {
    const auto found = std::ranges::find(columns_, column);
    if (found == columns_.end()) return std::numeric_limits<double>::quiet_NaN();
    return cells_.at(static_cast<std::size_t>(row))[static_cast<std::size_t>(found - columns_.begin())];
}

double CsvTable::number(int row, const std::string& column) const {
    const double value = at(row, column);
    if (!std::isfinite(value))
        throw InvalidInput(
            fmt::format("{}, column {}: the cell is empty. A number is needed here.", where(row), column));
    return value;
}

int CsvTable::integer(int row, const std::string& column) const {
    const double value = number(row, column);
    constexpr double most = std::numeric_limits<int>::max();
    if (value != std::floor(value) || std::abs(value) > most)
        throw InvalidInput(fmt::format("{}, column {}: {} is no whole number between {:.0f} and {:.0f}.", where(row),
                                       column, value, -most, most));
    return static_cast<int>(value);
}

const std::string& CsvTable::name(int row, const std::string& column) const {
    const auto found = std::ranges::find(columns_, column);
    const std::string& text =
        text_.at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(found - columns_.begin()));
    if (text.empty())
        throw InvalidInput(fmt::format("{}, column {}: the cell is empty. A name is needed here.", where(row), column));
    return text;
}

std::string CsvTable::where(int row) const {
    return fmt::format("{}, line {}", file_.filename().string(), lines_.at(static_cast<std::size_t>(row)));
}

}  // namespace palpate::mesh
