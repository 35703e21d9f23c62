#include "identify/recordings/files/text/table_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "identify/recordings/files/units.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

struct LineCount {
    int width = 0;  // cells, missing ones at the end too
    int cells = 0;  // without these
    int numbers = 0, missing = 0, others = 0;
    bool is_row() const { return numbers > 0 && numbers >= others; }
    bool is_blank() const { return numbers + others == 0; }
};

LineCount count_of(const TextFile& text, int line) {
    LineCount count;
    int at = 0;
    for (const std::string_view cell : text.cells(line)) {
        count.width = ++at;
        const auto kind = value_of(cell, text.dialect()).kind;
        if (!cell.empty()) count.cells = at;
        if (kind == CellValue::Kind::number)
            ++count.numbers;
        else if (kind == CellValue::Kind::missing)
            ++count.missing;
        else
            ++count.others;
    }
    return count;
}

bool is_comment(std::string_view line) {
    const std::string_view text = trimmed(line);
    return text.starts_with('#') || text.starts_with('%') || text.starts_with("//");
}

/// A run of rows; blank lines and comments do not end it.
struct Run {
    std::vector<int> rows;
    int width = 0, numbers = 0;
};

std::vector<Run> runs_of(const TextFile& text, int first) {
    std::vector<Run> runs;
    bool goes_on = false;
    for (int i = first; i < text.lines(); ++i) {
        if (is_comment(text.line(i))) continue;
        const LineCount count = count_of(text, i);
        if (count.is_blank() && count.missing <= 1) continue;
        // Cells that are missing at the end of a row may be left out.
        const bool is_row = count.is_row() || (goes_on && count.others == 0);
        if (!is_row) {
            goes_on = false;
            continue;
        }
        const int width = std::max(count.width, 1);
        // A few narrower rows above are settings; a single wider one is one too.
        constexpr std::size_t few = 3;
        if (!goes_on || (runs.back().rows.size() == 1 && width != runs.back().width) ||
            (runs.back().rows.size() <= few && width > runs.back().width))
            runs.emplace_back();
        goes_on = true;
        runs.back().rows.push_back(i);
        runs.back().width = std::max(runs.back().width, width);
        runs.back().numbers += count.numbers;
    }
    return runs;
}

/// A line of names: texts, about as many as a row has cells.
bool is_header(const TextFile& text, int line, int width) {
    const auto cells = header_cells(text, line, width);
    const auto size = static_cast<int>(cells.size());
    if (size < (width + 1) / 2 || size > width + 1 || (width > 1 && size < 2)) return false;
    int texts = 0, numbers = 0;
    for (const std::string_view cell : cells) {
        if (value_of(cell, text.dialect()).kind == CellValue::Kind::number)
            ++numbers;
        else if (!cell.empty())
            ++texts;
    }
    return texts > 0 && texts >= numbers;
}

bool is_unit_row(const TextFile& text, int line, int width) {
    const auto cells = header_cells(text, line, width);
    int told = 0;
    for (const std::string_view cell : cells) {
        if (cell.empty() && told > 1) break;  // what stands beyond a gap may be a remark
        if (cell.empty() || cell == "-") continue;
        if (!is_unit_cell(cell)) return false;
        ++told;
    }
    return told > 0 && static_cast<int>(cells.size()) <= width + 1;
}

int line_above(const TextFile& text, int line) {
    for (int i = line - 1; i >= 0; --i)
        if (!trimmed(text.line(i)).empty()) return i;
    return -1;
}

/// The line of names, and that of units between it and the numbers.
void find_names(const TextFile& text, const FileMap& map, TableLines& table) {
    TableHead& head = table.head;
    const int above = line_above(text, head.first_row);
    if (map.names_line) {
        head.names = *map.names_line - 1;
        if (head.names >= head.first_row)
            throw InvalidInput(
                fmt::format("{}: the map says that line {} names the columns, but the numbers begin in "
                            "line {}. Name a line above, or 0 where none does.",
                            text.file().filename().string(), *map.names_line, head.first_row + 1));
        if (above > head.names && head.names >= 0 && is_unit_row(text, above, table.width)) head.units = above;
        return;
    }
    if (above < 0) return;
    const int names = is_unit_row(text, above, table.width) ? line_above(text, above) : -1;
    if (names >= 0 && is_header(text, names, table.width)) {
        head.units = above;
        head.names = names;
    } else if (is_header(text, above, table.width)) {
        head.names = above;
    }
}

/// Names that come again stand below names of groups: "Tip,,,Base,," or "Tip,Tip,Tip,Base,Base,Base".
void find_groups(const TextFile& text, TableLines& table) {
    TableHead& head = table.head;
    const int above = head.names > 0 ? line_above(text, head.names) : -1;
    if (above < 0 || text.dialect().delimiter == ' ') return;
    const auto names = header_cells(text, head.names, table.width);
    const bool is_repeated = std::ranges::any_of(
        names, [&](std::string_view name) { return !name.empty() && std::ranges::count(names, name) > 1; });
    const auto groups = header_cells(text, above, table.width);
    const auto told = std::ranges::count_if(groups, [](std::string_view cell) { return !cell.empty(); });
    const bool is_of_texts = std::ranges::all_of(
        groups, [&](std::string_view cell) { return value_of(cell, text.dialect()).kind != CellValue::Kind::number; });
    if (is_repeated && told > 1 && is_of_texts && static_cast<int>(groups.size()) <= table.width) head.groups = above;
}

[[noreturn]] void refuse_line(const TextFile& text, int line) {
    for (const std::string_view cell : text.cells(line))
        if (value_of(cell, text.dialect()).kind == CellValue::Kind::date)
            throw InvalidInput(
                fmt::format("{}: {} is a date, where the table has numbers. A spreadsheet takes numbers for dates: "
                            "format the column as numbers and write the file again.",
                            text.where(line), mesh::cited(cell)));
    throw InvalidInput(fmt::format("{}: {} is no row of numbers, and the table goes on below. Mend or remove the line.",
                                   text.where(line), mesh::cited(text.line(line))));
}

/// A single line that is no row, within a table, is a fault, unless it names the columns of another table.
void require_no_fault(const TextFile& text, const Run& run, const Run& next) {
    if (next.width != run.width) return;
    int faults = 0, fault = -1;
    bool is_names = false;
    for (int i = run.rows.back() + 1; i < next.rows.front(); ++i) {
        const LineCount count = count_of(text, i);
        if (count.is_blank() || is_comment(text.line(i))) continue;
        ++faults;
        fault = i;
        is_names = run.width > 1 && count.numbers == 0 && count.others + 1 >= run.width;
    }
    if (faults == 1 && !is_names) refuse_line(text, fault);
}

}  // namespace

std::vector<std::string_view> header_cells(const TextFile& text, int line, int width) {
    // A tab at the beginning is an empty cell, after the sign of a comment it is none.
    std::string_view content = text.line(line);
    if (is_comment(content)) {
        content = trimmed(content);
        content = trimmed(content.substr(std::min(content.find_first_not_of("#%/"), content.size())));
    }
    auto cells = cells_of(content, text.dialect().delimiter);
    while (static_cast<int>(cells.size()) > width && cells.back().empty()) cells.pop_back();
    if (text.dialect().delimiter != ' ' || static_cast<int>(cells.size()) <= width) return cells;
    std::vector<std::string_view> wider;
    for (std::size_t at = 0; at < content.size();) {
        const std::size_t end = std::min({content.find("  ", at), content.find('\t', at), content.size()});
        if (const auto cell = trimmed(content.substr(at, end - at)); !cell.empty()) wider.push_back(cell);
        at = end + 1;
    }
    return static_cast<int>(wider.size()) == width ? wider : cells;
}

TableLines find_table(const TextFile& text, const FileMap& map) {
    const std::string name = text.file().filename().string();
    const int first = map.header_lines.value_or(0);
    const std::vector<Run> runs = runs_of(text, first);
    if (runs.empty())
        throw NoTable(
            fmt::format("{}: no row of numbers is found{}. Tell 'delimiter' and 'decimal' in a map, or "
                        "write the table as CSV.",
                        name, first > 0 ? fmt::format(" below line {}", first) : ""));
    // The longest is the measurement; shorter ones are results and settings. With its place told, it is the first.
    std::size_t chosen = 0;
    if (!map.header_lines)
        for (std::size_t r = 1; r < runs.size(); ++r)
            if (runs[r].numbers > runs[chosen].numbers) chosen = r;
    if (chosen + 1 < runs.size()) require_no_fault(text, runs[chosen], runs[chosen + 1]);
    if (chosen > 0) require_no_fault(text, runs[chosen - 1], runs[chosen]);
    TableLines table{
        .head = {.first_row = runs[chosen].rows.front()}, .rows = runs[chosen].rows, .width = runs[chosen].width};
    // Every row has its separators, unless it leaves out what is missing at its end; few do.
    constexpr std::size_t most_cells_a_byte = 4;
    if (static_cast<std::size_t>(table.width) * table.rows.size() > 1000 + most_cells_a_byte * text.bytes())
        throw InvalidInput(fmt::format(
            "{}: the longest row has {} cells, most have far fewer. Give every row its cells.", name, table.width));
    for (std::size_t r = 0; r < runs.size(); ++r)
        if (r != chosen && runs[r].width > 1 && runs[r].rows.size() > 1) table.others.push_back(runs[r].rows.front());
    find_names(text, map, table);
    find_groups(text, table);
    return table;
}

}  // namespace palpate::identify
