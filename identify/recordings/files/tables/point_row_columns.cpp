#include <algorithm>
#include <string_view>

#include "identify/recordings/files/tables/column_roles.h"
#include "identify/recordings/files/tables/table_recording.h"
#include "identify/recordings/files/text/cell.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

/// How programs name coordinates at rest and displacements; '@' stands for x, y and z. Names in this order go first.
constexpr std::string_view coordinate_names[]{"model_coordinates_@",
                                              "model_coordinate_@",
                                              "coordinate_@",
                                              "@_undef",
                                              "@ undef",
                                              "@_undf",
                                              "@_undeformed",
                                              "undeformed @",
                                              "@_ref",
                                              "ref_@",
                                              "reference @",
                                              "reference_@",
                                              "@_0",
                                              "@0",
                                              "coord_@",
                                              "coordinate @",
                                              "@-coordinate",
                                              "@ coordinate",
                                              "position @",
                                              "pos_@",
                                              "@"};
constexpr std::string_view displacement_names[]{"model_displacement_@",
                                                "displacement_@",
                                                "displacement @",
                                                "@-displacement",
                                                "@ displacement",
                                                "@_displacement",
                                                "displacement.@",
                                                "disp_@",
                                                "disp @",
                                                "disp.@",
                                                "u_@",
                                                "u@",
                                                "d@",
                                                "d_@",
                                                "delta_@",
                                                "delta @"};

int find_column(const NumberTable& table, std::string_view name, bool any_case) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        const std::string& own = table.columns[c].name;
        if (any_case ? lower_case(own) == lower_case(name) : own == name) return static_cast<int>(c);
    }
    return -1;
}

int find_any(const NumberTable& table, std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names)
        if (const int c = find_column(table, name, true); c >= 0) return c;
    return -1;
}

std::string with_axis(std::string_view pattern, char axis) {
    std::string name(pattern);
    std::ranges::replace(name, '@', axis);
    return name;
}

/// The first way of naming by which x and y are there. Large letters first: VIC-3D's small ones are pixels.
template <std::size_t n>
std::array<int, 3> by_names(const NumberTable& table, const std::string_view (&patterns)[n]) {
    for (const std::string_view pattern : patterns)
        for (const std::string_view axes : {"XYZ", "xyz"}) {
            std::array<int, 3> found{};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::string name = with_axis(pattern, axes[k]);
                found[k] = find_column(table, name, false);
                if (found[k] < 0 && pattern.size() > 1) found[k] = find_column(table, name, true);
            }
            if (found[0] >= 0 && found[1] >= 0) return found;
        }
    return {-1, -1, -1};
}

std::array<int, 3> displacements_in(const NumberTable& table) {
    for (const std::string_view letters : {"UVW", "uvw"}) {
        std::array<int, 3> found{};
        for (std::size_t k = 0; k < 3; ++k) found[k] = find_column(table, letters.substr(k, 1), false);
        if (found[0] >= 0 && found[1] >= 0) return found;
    }
    return by_names(table, displacement_names);
}

std::string program_of(const NumberTable& table) {
    // Version 1 has neither names of subsets nor flags.
    const bool is_dice =
        (find_any(table, {"subset_id", "status_flag", "match"}) >= 0 && find_any(table, {"gamma"}) >= 0) ||
        table.preamble.find("digital image correlation engine") != std::string::npos;
    if (is_dice) return "DICe, image correlation";
    const bool is_gom = table.preamble.find("gom") != std::string::npos ||
                        table.preamble.find("aramis") != std::string::npos || find_any(table, {"x_undef"}) >= 0;
    if (is_gom) return "GOM Aramis, image correlation";
    const bool is_vic = find_any(table, {"sigma"}) >= 0 &&
                        (find_column(table, "X", false) >= 0 || table.preamble.find("vic-3d") != std::string::npos);
    if (is_vic) return "VIC-3D, image correlation";
    return "image correlation, a row for each point";
}

/// "# Units: length:mm angle:deg time:s", "# Stage: Stufe 2", then "stage;index;relative_time;date" and its values: a
/// stage as GOM Correlate and ZEISS Inspect write it, with the places of the stage and the ways to them.
void take_stage(const NumberTable& table, PointRowColumns& columns) {
    const std::string& above = table.preamble;
    const bool is_stage = above.find("stage") != above.npos && above.find("units: length:") != above.npos;
    if (!is_stage || columns.displacement[0] < 0) return;
    columns.format = "GOM, image correlation";
    columns.are_moved = find_column(table, "x", true) == columns.at[0];
    const std::size_t unit = above.find("length:") + std::string_view("length:").size();
    columns.unit = above.substr(unit, above.find_first_of(" \t\r\n;", unit) - unit);
    std::size_t line = above.find("relative_time");
    if (line == above.npos) return;
    line = above.rfind('\n', line) + 1;  // npos + 1: it is the first
    const std::size_t end = above.find('\n', line), next_end = above.find('\n', end + 1);
    const char delimiter = above.find(';', line) < end ? ';' : ',';
    const auto names = cells_of(std::string_view(above).substr(line, end - line), delimiter);
    const auto values = cells_of(std::string_view(above).substr(end + 1, next_end - end - 1), delimiter);
    for (std::size_t c = 0; c < names.size() && c < values.size(); ++c)
        if (trimmed(names[c]) == "relative_time") columns.instant = mesh::parse_number(std::string(trimmed(values[c])));
}

PointRowColumns told_by_map(const NumberTable& table, const std::string& file, const FileMap& map) {
    PointRowColumns columns{.format = "table, a row for each point"};
    const auto index = [&](const ColumnPlace& place) { return column_of(table, place.column, file); };
    if (map.point_column) columns.point = index(*map.point_column);
    if (map.frame_column) columns.frame = index(*map.frame_column);
    if (map.time) columns.time = index(*map.time);
    if (!map.points.empty()) {
        for (std::size_t k = 0; k < map.points[0].at.size(); ++k) columns.at[k] = index(map.points[0].at[k]);
        for (std::size_t k = 0; k < map.points[0].displacement.size(); ++k)
            columns.displacement[k] = index(map.points[0].displacement[k]);
        return columns;
    }
    columns.at = by_names(table, coordinate_names);
    columns.displacement = displacements_in(table);
    columns.quality = find_any(table, {"sigma"});
    if (columns.displacement[0] >= 0) columns.format = program_of(table);
    take_stage(table, columns);
    return columns;
}

}  // namespace

std::optional<PointRowColumns> point_rows_in(const NumberTable& table, const TextFile& text, const FileMap& map) {
    if (map.point_column || map.format == "dic") return told_by_map(table, text.file().filename().string(), map);
    if (!table.has_names || !map.points.empty() || !map.channels.empty()) return std::nullopt;
    PointRowColumns columns;
    columns.at = by_names(table, coordinate_names);
    if (columns.at[0] < 0) return std::nullopt;
    for (const int c : columns.at)
        if (c >= 0 && table.columns[static_cast<std::size_t>(c)].is_text) return std::nullopt;
    columns.displacement = displacements_in(table);
    columns.point = find_any(table, {"id", "subset_id", "point_id", "point", "marker", "marker_id", "name", "label",
                                     "node", "facet", "landmark", "point id", "facet id", "track_id", "particle"});
    columns.frame = find_any(table, {"frame", "stage", "step", "image", "frame_number"});
    columns.time = roles_of(table).time;
    columns.quality = find_any(table, {"sigma"});
    const bool is_moving = columns.frame >= 0 || columns.time >= 0;
    const bool has_displacement = columns.displacement[0] >= 0;
    // "index" names points as well as rows: where nothing else does, and they do not move within the table
    if (has_displacement && columns.point < 0 && !is_moving) columns.point = find_any(table, {"index"});
    // With instants and without names it is one point that moves; image correlation tells from where.
    if (is_moving && columns.point < 0 && !has_displacement) return std::nullopt;
    columns.format = has_displacement ? program_of(table) : "table, a row for each point";
    take_stage(table, columns);
    return columns;
}

}  // namespace palpate::identify
