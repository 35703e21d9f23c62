#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/tables/column_roles.h"
#include "identify/recordings/files/tables/table_recording.h"
#include "identify/recordings/files/text/decoding/open_text.h"
#include "identify/recordings/files/units.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

/// Columns that a map names, in this file and those beside it.
class MappedColumns {
public:
    MappedColumns(const NumberTable& table, const TextFile& text, const FileMap& map)
        : table_(table), text_(text), map_(map) {}

    /// @throws InvalidInput where there is no such column, its file has other rows, or it holds texts.
    const NumberColumn& numbers(const ColumnPlace& place) {
        const NumberColumn& column = any(place);
        if (column.is_text)
            throw InvalidInput(
                fmt::format("{}: the column {} holds texts or dates, such as {}; numbers are needed. A "
                            "spreadsheet takes numbers for dates: format the column as numbers and write "
                            "the file again.",
                            name_of(place), mesh::cited(place.column), mesh::cited(first_text(column))));
        return column;
    }

    const NumberColumn& any(const ColumnPlace& place) {
        const NumberTable& table = place.file.empty() ? table_ : other(place.file);
        if (table.rows() != table_.rows())
            throw InvalidInput(
                fmt::format("{} has {} rows, {} has {}. Columns of one recording need the same rows; "
                            "import the files apart where their clocks differ.",
                            name_of(place), table.rows(), text_.file().filename().string(), table_.rows()));
        return table.columns[static_cast<std::size_t>(column_of(table, place.column, name_of(place)))];
    }

private:
    static std::string first_text(const NumberColumn& column) {
        for (const std::string& cell : column.texts)
            if (!cell.empty()) return cell;
        return {};
    }

    std::string name_of(const ColumnPlace& place) const {
        return place.file.empty() ? text_.file().filename().string() : place.file;
    }

    const NumberTable& other(const std::string& file) {
        auto& kept = others_[file];
        if (!kept) {
            FileMap map;
            map.encoding = map_.encoding;
            kept =
                std::make_unique<NumberTable>(read_number_table(*open_text(file_beside(text_.file(), file), map), map));
        }
        return *kept;
    }

    const NumberTable& table_;
    const TextFile& text_;
    const FileMap& map_;
    std::map<std::string, std::unique_ptr<NumberTable>> others_;
};

Eigen::Matrix3Xd coordinates(const std::vector<ColumnPlace>& places, Eigen::Index rows, double factor,
                             MappedColumns& columns) {
    Eigen::Matrix3Xd at = Eigen::Matrix3Xd::Zero(3, rows);  // z of a plane is 0
    for (std::size_t k = 0; k < places.size(); ++k)
        at.row(static_cast<Eigen::Index>(k)) = factor * columns.numbers(places[k]).values.transpose();
    drop_partly_seen(at);
    return at;
}

/// One of the table's own.
const NumberColumn& own_column(const NumberTable& table, int c) { return table.columns[static_cast<std::size_t>(c)]; }

/// As the first point tells it whose columns do.
std::string told_unit(const NumberTable& table, const std::vector<PointColumns>& points) {
    for (const PointColumns& point : points)
        if (const std::string& unit = own_column(table, point.at[0]).unit; !unit.empty()) return unit;
    return {};
}

void add_mapped_points(const FileMap& map, const std::string& file, Eigen::Index rows, MappedColumns& columns,
                       Recording& recording) {
    const double factor = position_factor(map, columns.numbers(map.points[0].at[0]).unit, file, recording);
    for (const MappedPoint& point : map.points) {
        recording.points.push_back({point.name, coordinates(point.at, rows, factor, columns), {}});
        if (!point.displacement.empty())
            recording.points.back().displacement = coordinates(point.displacement, rows, factor, columns);
    }
}

void add_found_points(const NumberTable& table, const ColumnRoles& roles, const FileMap& map, const std::string& file,
                      Recording& recording) {
    const std::string told = told_unit(table, roles.points);
    const double factor = position_factor(map, told, file, recording);
    for (const PointColumns& point : roles.points) {
        const std::string& own = own_column(table, point.at[0]).unit;
        const bool is_other = map.unit.empty() && !own.empty() && own != told;
        Eigen::Matrix3Xd at = Eigen::Matrix3Xd::Zero(3, table.rows());
        for (std::size_t k = 0; k < 3; ++k)
            if (point.at[k] >= 0)
                at.row(static_cast<Eigen::Index>(k)) =
                    (is_other ? length_in_mm(own, file) : factor) * own_column(table, point.at[k]).values.transpose();
        drop_partly_seen(at);
        recording.points.push_back({point.name, std::move(at), {}});
    }
}

void add_mapped_channels(const FileMap& map, MappedColumns& columns, Recording& recording) {
    for (const MappedChannel& channel : map.channels) {
        const NumberColumn& column = columns.numbers(channel.place);
        const std::string name = !channel.name.empty()  ? channel.name
                                 : !column.name.empty() ? column.name
                                                        : fmt::format("column {}", channel.place.column);
        recording.channels.push_back(
            in_our_units(name, channel.unit.empty() ? column.unit : channel.unit, column.values));
    }
}

void add_found_channels(const NumberTable& table, const ColumnRoles& roles, Recording& recording) {
    for (const int c : roles.channels) {
        const NumberColumn& column = own_column(table, c);
        recording.channels.push_back(in_our_units(column.name.empty() ? fmt::format("column {}", c + 1) : column.name,
                                                  column.unit, column.values));
    }
}

void set_clock(const NumberTable& table, const TextFile& text, const FileMap& map, const NumberColumn* time, int frame,
               Recording& recording) {
    if (map.rate) {
        set_rate(*map.rate, table.rows(), 0, recording);
    } else if (time) {
        set_times(
            *time, map, [&](Eigen::Index r) { return text.where(table.lines[static_cast<std::size_t>(r)]); },
            recording);
    } else {
        set_no_clock(table.rows(), recording);
        if (frame >= 0) recording.times = table.columns[static_cast<std::size_t>(frame)].values;
        recording.notes.emplace_back("no clock is found: 'rate' or 'time' in a map tells it");
    }
}

}  // namespace

Recording rows_of_instants(const NumberTable& table, const TextFile& text, const FileMap& map) {
    const std::string file = text.file().filename().string();
    Recording recording = begun(file, "");
    recording.notes = table.notes;
    MappedColumns columns(table, text, map);
    const ColumnRoles roles = roles_of(table);
    const bool is_mapped = !map.points.empty() || !map.channels.empty();
    if (!is_mapped) recording.notes.insert(recording.notes.end(), roles.notes.begin(), roles.notes.end());

    const NumberColumn* time = map.time                                             ? &columns.any(*map.time)
                               : roles.time >= 0 && (!is_mapped || table.has_names) ? &own_column(table, roles.time)
                                                                                    : nullptr;
    set_clock(table, text, map, time, roles.frame, recording);
    if (is_mapped) {
        if (!map.points.empty()) add_mapped_points(map, file, table.rows(), columns, recording);
        add_mapped_channels(map, columns, recording);
    } else {
        if (!roles.points.empty()) add_found_points(table, roles, map, file, recording);
        add_found_channels(table, roles, recording);
    }
    name_points(map, file, recording);
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        const NumberColumn& column = table.columns[c];
        if (!column.is_text || &column == time) continue;
        recording.notes.push_back(fmt::format("column {} holds texts: left out", column.name.empty()
                                                                                     ? fmt::format("{}", c + 1)
                                                                                     : mesh::cited(column.name)));
    }
    return recording;
}

}  // namespace palpate::identify
