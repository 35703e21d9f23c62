#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/tables/table_recording.h"
#include "identify/recordings/files/text/decoding/open_text.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

/// Which frame and which point each row is of.
struct RowPlaces {
    std::vector<double> frames;             // their numbers or times, ascending
    std::vector<std::string> points;        // their names, in the order of the file
    std::vector<std::size_t> frame, point;  // of each row
};

std::string name_in(const NumberColumn& column, Eigen::Index row) {
    if (column.is_text) return column.texts[static_cast<std::size_t>(row)];
    return fmt::format("{}", column.values[row]);
}

RowPlaces places_of(const NumberTable& table, const PointRowColumns& columns, const TextFile& text) {
    RowPlaces places;
    const Eigen::Index rows = table.rows();
    const int key = columns.frame >= 0 ? columns.frame : columns.time;
    const auto where = [&](Eigen::Index r) { return text.where(table.lines[static_cast<std::size_t>(r)]); };
    const auto column = [&](int c) -> const NumberColumn& { return table.columns[static_cast<std::size_t>(c)]; };
    if (key >= 0) {
        if (column(key).is_text)
            throw InvalidInput(fmt::format("{}: the column {} of frames holds texts; numbers are needed.",
                                           text.file().filename().string(), mesh::cited(column(key).name)));
        for (Eigen::Index r = 0; r < rows; ++r)
            if (!std::isfinite(column(key).values[r]))
                throw InvalidInput(fmt::format("{}, column {}: the cell is empty. Each row needs its frame.", where(r),
                                               column(key).name));
        const std::set<double> all(column(key).values.begin(), column(key).values.end());
        places.frames.assign(all.begin(), all.end());
    } else {
        places.frames = {0};
    }
    std::map<std::string, std::size_t> index_of;
    std::vector<std::size_t> count(places.frames.size());
    for (Eigen::Index r = 0; r < rows; ++r) {
        std::size_t f = 0;
        if (key >= 0)
            f = static_cast<std::size_t>(std::ranges::lower_bound(places.frames, column(key).values[r]) -
                                         places.frames.begin());
        std::string name = columns.point >= 0 ? name_in(column(columns.point), r) : fmt::format("{}", count[f] + 1);
        ++count[f];
        const auto [found, is_new] = index_of.try_emplace(name, places.points.size());
        if (is_new) places.points.push_back(std::move(name));
        places.frame.push_back(f);
        places.point.push_back(found->second);
    }
    return places;
}

/// Frames and points that a table names, but has hardly a row for: no table of a measurement.
void require_filled(const RowPlaces& places, const std::string& file) {
    constexpr double most_empty = 1000;  // places a row
    const double size = static_cast<double>(places.frames.size()) * static_cast<double>(places.points.size());
    if (size > most_empty * static_cast<double>(places.frame.size()))
        throw InvalidInput(
            fmt::format("{}: {} frames and {} points are named in {} rows only. Is it these columns that "
                        "tell frame and point? Name them in a map.",
                        file, places.frames.size(), places.points.size(), places.frame.size()));
}

Vec3 triple(const NumberTable& table, const std::array<int, 3>& columns, Eigen::Index row) {
    Vec3 value = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
        if (const int c = columns[static_cast<std::size_t>(k)]; c >= 0)
            value[k] = table.columns[static_cast<std::size_t>(c)].values[row];
    return value;
}

void set_frame_clock(const NumberTable& table, const PointRowColumns& columns, const RowPlaces& places,
                     const FileMap& map, const TextFile& text, Recording& recording) {
    const auto frames = static_cast<Eigen::Index>(places.frames.size());
    if (map.rate) return set_rate(*map.rate, frames, 0, recording);
    if (columns.time >= 0) {
        NumberColumn time = table.columns[static_cast<std::size_t>(columns.time)];
        Eigen::VectorXd of_frame(frames);
        for (std::size_t r = 0; r < places.frame.size() && !time.is_text; ++r)
            of_frame[static_cast<Eigen::Index>(places.frame[r])] = time.values[static_cast<Eigen::Index>(r)];
        if (!time.is_text) {
            time.values = of_frame;
            return set_times(
                time, map,
                [&](Eigen::Index f) {
                    return fmt::format("{}, frame {}", text.file().filename().string(),
                                       places.frames[static_cast<std::size_t>(f)]);
                },
                recording);
        }
    }
    if (columns.instant && frames == 1) {
        recording.times = Eigen::VectorXd::Constant(1, *columns.instant);
        recording.has_clock = true;
        return;
    }
    set_no_clock(frames, recording);
    if (columns.frame >= 0) recording.times = Eigen::Map<const Eigen::VectorXd>(places.frames.data(), frames);
    recording.notes.emplace_back("no clock is found: 'rate' in a map tells it");
}

}  // namespace

Recording rows_of_points(const NumberTable& table, const PointRowColumns& columns, const TextFile& text,
                         const FileMap& map) {
    const std::string file = text.file().filename().string();
    if (columns.at[0] < 0 || columns.at[1] < 0)
        throw InvalidInput(
            fmt::format("{}: no columns of coordinates are found. Name them in a map: points: [{{name: any, "
                        "at: [x, y, z]}}].",
                        file));
    Recording recording = begun(file, columns.format);
    recording.notes = table.notes;
    for (const auto& triple : {columns.at, columns.displacement})
        for (const int c : triple)
            if (c >= 0 && table.columns[static_cast<std::size_t>(c)].is_text)
                throw InvalidInput(fmt::format("{}: the column {} holds texts; numbers are needed.", file,
                                               mesh::cited(table.columns[static_cast<std::size_t>(c)].name)));
    const RowPlaces places = places_of(table, columns, text);
    require_filled(places, file);

    const bool has_displacement = columns.displacement[0] >= 0;
    std::string told = table.columns[static_cast<std::size_t>(columns.at[0])].unit;
    const bool is_in_pixels = columns.format.starts_with("DICe") && columns.at[2] < 0;
    if (told.empty()) told = is_in_pixels ? "pixel" : columns.unit;
    const double factor = position_factor(map, told, file, recording);
    set_frame_clock(table, columns, places, map, text, recording);

    const auto frames = static_cast<Eigen::Index>(places.frames.size());
    for (const std::string& name : places.points) {
        recording.points.push_back({name, Eigen::Matrix3Xd::Constant(3, frames, not_seen), {}});
        if (has_displacement) recording.points.back().displacement = Eigen::Matrix3Xd::Constant(3, frames, not_seen);
    }
    std::vector<char> seen(places.frames.size() * places.points.size());
    int lost = 0;
    for (Eigen::Index r = 0; r < table.rows(); ++r) {
        const std::size_t f = places.frame[static_cast<std::size_t>(r)], p = places.point[static_cast<std::size_t>(r)];
        char& is_seen = seen[f * places.points.size() + p];
        if (is_seen)
            throw InvalidInput(
                fmt::format("{}: the point {} comes twice in one frame. Name it once, or tell which column "
                            "is the frame in a map.",
                            text.where(table.lines[static_cast<std::size_t>(r)]), mesh::cited(places.points[p])));
        is_seen = 1;
        const bool is_lost =
            columns.quality >= 0 && table.columns[static_cast<std::size_t>(columns.quality)].values[r] < 0;
        lost += is_lost;
        const Vec3 at = triple(table, columns.at, r), moved = triple(table, columns.displacement, r);
        if (is_lost || !at.allFinite() || !moved.allFinite()) continue;
        const Vec3 now = columns.are_moved ? at : Vec3(at + moved);
        recording.points[p].at.col(static_cast<Eigen::Index>(f)) = factor * now;
        if (has_displacement) recording.points[p].displacement.col(static_cast<Eigen::Index>(f)) = factor * moved;
    }
    if (has_displacement)
        recording.notes.emplace_back(columns.are_moved
                                         ? "coordinates are those of the stage: displacements lead to them"
                                         : "coordinates are those at rest: positions are these and the displacements");
    if (lost > 0) recording.notes.push_back(fmt::format("{} rows of a negative sigma: not found there", lost));
    if (columns.point < 0) recording.notes.emplace_back("points are named by the order of their rows");
    name_points(map, file, recording);
    return recording;
}

/// "plate_0001.tif_U[mm].csv": MatchID writes a coordinate over the image into a file each.
bool is_matrix_of_image(const std::string& file) {
    for (const char quantity : {'U', 'V', 'W', 'X', 'Y', 'Z'})
        for (const char* unit : {"mm", "pixel"})
            if (file.find(fmt::format("_{}[{}]", quantity, unit)) != file.npos) return true;
    return false;
}

Recording read_table(const TextFile& text, const FileMap& map) {
    const NumberTable table = read_number_table(text, map);
    const std::string file = text.file().filename().string();
    if (!table.has_names && map.points.empty() && map.channels.empty() && is_matrix_of_image(file))
        throw InvalidInput(fmt::format(
            "{}: one quantity over the image, {} rows and {} columns, as MatchID writes it, and no places that "
            "it belongs to. Export the points instead: a row for each, with columns x, y, u, v.",
            file, table.rows(), table.columns.size()));
    if (const auto columns = point_rows_in(table, text, map)) return rows_of_points(table, *columns, text, map);
    Recording recording = rows_of_instants(table, text, map);
    const auto tells = [&](const char* word) { return table.preamble.find(word) != std::string::npos; };
    const bool is_zwick = tells("standardkraft") || tells("standard force") || tells("testxpert") || tells("zwick") ||
                          tells("standardweg") || tells("traversenweg") ||
                          (tells("force standard") && tells("traverse"));
    const bool is_bluehill =
        tells("bluehill") || tells("instron") || tells("specimen label") || (tells("extension") && tells("load"));
    recording.format = is_zwick                  ? "testing machine, Zwick testXpert"
                       : is_bluehill             ? "testing machine, Instron Bluehill"
                       : map.format == "machine" ? "testing machine"
                                                 : "table, a row for each instant";
    return recording;
}

}  // namespace palpate::identify
