#include "identify/recordings/files/draft_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "identify/recordings/files/tables/column_roles.h"
#include "identify/recordings/files/tables/table_recording.h"
#include "identify/recordings/files/text/decoding/open_text.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"

namespace palpate::identify {
namespace {

/// In double quotes, as YAML reads it back.
std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        if (static_cast<unsigned char>(c) < 0x20)
            result += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
        else
            result += c;
    }
    return result + "\"";
}

std::string column_name(const NumberTable& table, int column) {
    const std::string& name = table.columns[static_cast<std::size_t>(column)].name;
    const auto count = std::ranges::count_if(
        table.columns, [&](const NumberColumn& other) { return lower_case(other.name) == lower_case(name); });
    return quoted(name.empty() || count > 1 ? fmt::format("{}", column + 1) : name);
}

constexpr std::size_t most_mapped = 200;  // points or channels: a map of more is edited by no one

std::string instant_columns(const NumberTable& table) {
    const ColumnRoles roles = roles_of(table);
    std::string text;
    if (roles.time >= 0) text += fmt::format("    time: {}\n", column_name(table, roles.time));
    if (!roles.points.empty() && roles.points.size() <= most_mapped) {
        text += "    points:\n";
        for (const PointColumns& point : roles.points) {
            std::vector<std::string> at;
            for (const int c : point.at)
                if (c >= 0) at.push_back(column_name(table, c));
            text += fmt::format("      - {{name: {}, at: [{}]}}\n", quoted(point.name), fmt::join(at, ", "));
        }
    }
    if (!roles.channels.empty() && roles.channels.size() <= most_mapped) {
        text += "    channels:\n";
        for (const int c : roles.channels) {
            const std::string& unit = table.columns[static_cast<std::size_t>(c)].unit;
            text += fmt::format("      - {{column: {}{}}}\n", column_name(table, c),
                                unit.empty() ? "" : ", unit: " + quoted(unit));
        }
    }
    return text;
}

std::string point_columns(const NumberTable& table, const PointRowColumns& columns) {
    std::string text;
    if (columns.point >= 0) text += fmt::format("    point_column: {}\n", column_name(table, columns.point));
    if (columns.frame >= 0) text += fmt::format("    frame_column: {}\n", column_name(table, columns.frame));
    if (columns.time >= 0) text += fmt::format("    time: {}\n", column_name(table, columns.time));
    return text;
}

/// What was found out about a text with a table.
std::string table_lines(const std::filesystem::path& file) {
    const FileMap nothing;
    const auto text = try_text(file, mesh::read_text(file), nothing);
    if (!text) return {};
    const Dialect& dialect = text->dialect();
    std::string lines = fmt::format("    delimiter: {}\n", dialect.delimiter == ','    ? "comma"
                                                           : dialect.delimiter == ';'  ? "semicolon"
                                                           : dialect.delimiter == '\t' ? "tab"
                                                                                       : "blanks");
    if (dialect.decimal == ',') lines += "    decimal: comma\n";
    try {
        const NumberTable table = read_number_table(*text, nothing);
        if (const auto columns = point_rows_in(table, *text, nothing)) return lines + point_columns(table, *columns);
        return lines + instant_columns(table);
    } catch (const InvalidInput&) {
        return lines + "    header_lines: 1  # lines before the first row of numbers\n";
    }
}

constexpr const char* further =
    "    # format: table       # c3d, trc, motive, vicon, machine, dic, mat, exodus, scan, table or sheets\n"
    "    # encoding: latin-1   # utf-8, utf-16\n"
    "    # header_lines: 5     # lines before the first row of numbers; names_line: the one that names the columns\n"
    "    # rate: 200           # frames a second, where no column tells the time; time_unit: ms\n"
    "    # unit: mm            # of positions: cm, m, um, in, or pixel (then 'pixel: 0.05', its size in mm)\n"
    "    # names: [base, tip]  # of all points, in their order\n"
    "    # points: [{name: tip, at: [\"3\", \"4\", \"5\"]}]               # columns by name, or by number from 1\n"
    "    # channels: [{column: \"2\", name: force, unit: N, file: b.dat}]  # file: another one with the same rows\n"
    "    # point_column: id    # a row for each point; frame_column: frame\n"
    "    # sheets: {at: [xt.dat, yt.dat], rest: [x0.dat, y0.dat], frames_in: columns}  # matrices, one a coordinate\n"
    "    # series: true        # all files beside this one that differ in their number only, each a frame\n";

}  // namespace

std::string draft_map(const std::filesystem::path& file, const std::vector<Recording>& recordings,
                      const FileMap& told) {
    std::string text = fmt::format("files:\n  - file: {}\n", quoted(file.filename().string()));
    if (!told.unit.empty()) text += fmt::format("    unit: {}\n", told.unit);
    if (told.pixel > 0) text += fmt::format("    pixel: {:g}\n", told.pixel);
    const bool is_table = recordings.empty() || recordings[0].format.starts_with("table") ||
                          recordings[0].format.starts_with("testing machine") ||
                          recordings[0].format.find("image correlation") != std::string::npos;
    const bool is_file = std::filesystem::is_regular_file(file);
    if (is_table && is_file && file.extension() != ".mat") return text + table_lines(file) + further;
    for (const Recording& recording : recordings) {
        if (recording.points.empty() || recording.points.size() > most_mapped) continue;
        std::vector<std::string> names;
        for (const RecordedPoint& point : recording.points) names.push_back(quoted(point.name));
        text += fmt::format("    names: [{}]\n", fmt::join(names, ", "));
    }
    if (!is_file) text += "    series: true\n";
    return text + further;
}

}  // namespace palpate::identify
