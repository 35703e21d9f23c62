#include "mesh/text/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
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

/// The cells of a line; in a cell in double quotes neither the separator nor '#' means anything.
std::vector<std::string_view> split(std::string_view line, char separator) {
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
        if (line[i] == separator && !in_quotes) close_cell(i);
    }
    close_cell(i);
    const bool blank = std::ranges::all_of(cells, &std::string_view::empty);
    return blank ? std::vector<std::string_view>{} : cells;
}

/// What separates the cells of a file with this header.
char separator_of(std::string_view header) {
    for (const char separator : {';', '\t'})
        if (split(header, separator).size() > 1) return separator;
    return ',';
}

std::string in_small_letters(std::string_view text) {
    std::string small(text);
    for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return small;
}

struct ColumnHead {
    std::string name, unit;
};

/// "X [mm]" or "x (mm)" is the column x, in mm.
ColumnHead column_head(std::string_view cell) {
    const std::size_t open = cell.find_first_of("[(");
    if (open == std::string_view::npos || open == 0 || (cell.back() != ']' && cell.back() != ')'))
        return {in_small_letters(cell), ""};
    return {in_small_letters(without_spaces(cell.substr(0, open))),
            std::string(without_spaces(cell.substr(open + 1, cell.size() - open - 2)))};
}

/// A number, with a decimal comma where commas do not separate; NaN where nothing was measured.
std::optional<double> number_in(std::string_view cell, char separator) {
    const std::string small = in_small_letters(cell);
    if (small.empty() || small == "nan" || small == "na" || small == "n/a")
        return std::numeric_limits<double>::quiet_NaN();
    if (separator == ',' || cell.find('.') != std::string_view::npos) return parse_number(cell);
    std::string with_point(cell);
    if (const std::size_t comma = with_point.find(','); comma != std::string::npos) with_point[comma] = '.';
    return parse_number(with_point);
}

void check_columns(const std::vector<std::string>& columns, const std::string& where,
                   const std::vector<std::string>& required, const std::vector<std::string>& optional) {
    std::vector<std::string> known = required;
    known.insert(known.end(), optional.begin(), optional.end());
    const std::string allowed = fmt::format("required: {}{}{}", fmt::join(required, ","),
                                            optional.empty() ? "" : "; optional: ", fmt::join(optional, ","));
    if (columns.size() == 1 && required.size() > 1 && columns[0].find(' ') != std::string::npos)
        throw InvalidInput(
            fmt::format("{}: the header {} holds no comma, semicolon or tab. Separate the cells by commas "
                        "({}).",
                        where, cited(columns[0]), allowed));
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
    const std::string whole = read_text(file);
    std::string_view rest = whole;
    require_utf8(whole, file.filename().string());
    if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);

    char separator = ',';
    std::vector<char> is_name;  // of each column
    for (int line = 1; !rest.empty(); ++line) {
        const auto end = std::min(rest.find('\n'), rest.size());
        const std::string_view text = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (columns_.empty()) separator = separator_of(text);
        const auto cells = split(text, separator);
        if (cells.empty()) continue;

        const std::string here = fmt::format("{}, line {}", file.filename().string(), line);
        if (columns_.empty()) {
            for (const std::string_view cell : cells) {
                ColumnHead head = column_head(cell);
                columns_.push_back(std::move(head.name));
                units_.push_back(std::move(head.unit));
            }
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
        std::vector<std::string> row_names(names.empty() ? 0 : cells.size());
        for (std::size_t c = 0; c < cells.size(); ++c) {
            if (is_name[c]) {
                row_names[c] = cells[c];
                row.push_back(std::numeric_limits<double>::quiet_NaN());
                continue;
            }
            const auto value = number_in(cells[c], separator);
            if (!value)
                throw InvalidInput(
                    fmt::format("{}, column {}: {} is no number. Write finite numbers as 12.5 or 1.25e1, "
                                "or leave the cell empty where a value is missing.",
                                here, columns_[c], cited(cells[c])));
            row.push_back(*value);
        }
        lines_.push_back(line);
        cells_.push_back(std::move(row));
        text_.push_back(std::move(row_names));
    }
    if (columns_.empty())
        throw InvalidInput(fmt::format("{}: the file is empty. Its first line names the columns: {}.",
                                       file.filename().string(), fmt::join(required, ",")));
}

void CsvTable::require_unit(const std::vector<std::string>& columns, const std::string& unit,
                            const std::string& told) const {
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        if (units_[c].empty() || units_[c] == unit || std::ranges::find(columns, columns_[c]) == columns.end())
            continue;
        throw InvalidInput(
            fmt::format("{}, column {}: its header says [{}], and {} says {}. Correct one of them, or "
                        "convert the column.",
                        file_.filename().string(), columns_[c], units_[c], told, unit));
    }
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

const std::string& CsvTable::text(int row, const std::string& column) const {
    const auto found = std::ranges::find(columns_, column);
    return text_.at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(found - columns_.begin()));
}

const std::string& CsvTable::name(int row, const std::string& column) const {
    const std::string& words = text(row, column);
    if (words.empty())
        throw InvalidInput(fmt::format("{}, column {}: the cell is empty. A name is needed here.", where(row), column));
    return words;
}

std::string CsvTable::where(int row) const {
    return fmt::format("{}, line {}", file_.filename().string(), lines_.at(static_cast<std::size_t>(row)));
}

}  // namespace palpate::mesh
