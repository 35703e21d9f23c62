#include "identify/recordings/files/conversion.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "identify/recordings/files/units.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

constexpr double day = 86400;  // [s]

/// Values that count from 1970: in which unit.
struct SinceEpoch {
    double least;
    double factor;  // [s]
    const char* unit;
};
constexpr SinceEpoch since_epoch[]{{1e17, 1e-9, "ns"}, {1e14, 1e-6, "us"}, {1e11, 1e-3, "ms"}, {1e9, 1, "s"}};

double factor_of(const NumberColumn& column, const FileMap& map, Recording& recording) {
    const std::string& told = map.time_unit.empty() ? column.unit : map.time_unit;
    if (const auto unit = unit_in_ours(told); unit && unit->name == "s") return unit->factor;
    if (told.empty() && column.values.size() > 0)
        for (const SinceEpoch& each : since_epoch)
            if (column.values[0] > each.least) {
                recording.notes.push_back(fmt::format("times count {} since 1970", each.unit));
                return each.factor;
            }
    if (!told.empty())
        recording.notes.push_back(fmt::format("{} is no unit of time: taken as s", mesh::cited(told)));
    else if (!column.name.empty())
        recording.notes.emplace_back("no unit of time is told: taken as s");
    return 1;
}

Eigen::VectorXd times_of_day(const NumberColumn& column, const std::function<std::string(Eigen::Index)>& where) {
    Eigen::VectorXd times(column.values.size());
    double days = 0;
    for (Eigen::Index r = 0; r < times.size(); ++r) {
        const std::string& cell = column.texts[static_cast<std::size_t>(r)];
        const auto time = clock_time(cell);
        if (!time)
            throw InvalidInput(
                fmt::format("{}, column {}: {} is no time. Times are numbers, 12:01:33.5, or such with a "
                            "date; name another column as 'time' in a map, or tell a 'rate'.",
                            where(r), mesh::cited(column.name), mesh::cited(cell)));
        times[r] = *time + days;
        const bool is_past_midnight = *time < day && r > 0 && times[r] < times[r - 1] - day / 2;
        if (is_past_midnight) times[r] += day, days += day;
    }
    return times;
}

}  // namespace

Recording begun(const std::string& source, const std::string& format) {
    Recording recording;
    recording.source = source;
    recording.format = format;
    return recording;
}

void drop_partly_seen(Eigen::Matrix3Xd& at) {
    for (Eigen::Index f = 0; f < at.cols(); ++f)
        if (!at.col(f).allFinite()) at.col(f).setConstant(not_seen);
}

void set_rate(double rate, Eigen::Index frames, double first, Recording& recording) {
    recording.times = Eigen::VectorXd::LinSpaced(frames, first, first + static_cast<double>(frames - 1)) / rate;
    recording.has_clock = true;
}

void set_no_clock(Eigen::Index frames, Recording& recording) {
    recording.times = Eigen::VectorXd::LinSpaced(frames, 0, static_cast<double>(frames - 1));
    recording.has_clock = false;
}

void set_times(const NumberColumn& column, const FileMap& map, const std::function<std::string(Eigen::Index)>& where,
               Recording& recording) {
    if (column.is_text) {
        recording.times = times_of_day(column, where);
        recording.notes.emplace_back("times are times of day, or dates with them");
    } else {
        recording.times = column.values * factor_of(column, map, recording);
    }
    int repeated = 0;
    for (Eigen::Index r = 0; r < recording.times.size(); ++r) {
        if (!std::isfinite(recording.times[r]))
            throw InvalidInput(
                fmt::format("{}: the time is missing. Complete it, remove the line, or tell a 'rate' in a "
                            "map.",
                            where(r)));
        if (r == 0) continue;
        if (recording.times[r] < recording.times[r - 1])
            throw InvalidInput(
                fmt::format("{}: time runs backwards, from {} to {}. Cut the file there, name another "
                            "column as 'time' in a map, or tell a 'rate'.",
                            where(r), column.is_text ? recording.times[r - 1] : column.values[r - 1],
                            column.is_text ? recording.times[r] : column.values[r]));
        if (recording.times[r] == recording.times[r - 1]) ++repeated;
    }
    if (repeated > 0) recording.notes.push_back(fmt::format("{} times are those of the row before", repeated));
    recording.has_clock = true;
}

double position_factor(const FileMap& map, const std::string& told, const std::string& file, Recording& recording) {
    const std::string& unit = map.unit.empty() ? told : map.unit;
    const std::string lower = lower_case(unit);
    if (lower == "pixel" || lower == "pixels" || lower == "px") {
        if (map.pixel > 0) return map.pixel;
        recording.in_pixels = true;
        recording.notes.emplace_back(
            "positions are in pixels, taken as 1 mm each: 'unit: pixel' and 'pixel' [mm] in a map tell their size");
        return 1;
    }
    if (unit.empty()) {
        recording.notes.emplace_back("no unit of positions is given: taken as mm; 'unit' in a map gives another");
        return 1;
    }
    const double factor = length_in_mm(unit, file);
    if (factor != 1) recording.notes.push_back(fmt::format("positions are in {}, here in mm", unit));
    return factor;
}

void name_points(const FileMap& map, const std::string& file, Recording& recording) {
    if (map.names.empty()) return;
    if (map.names.size() != recording.points.size())
        throw InvalidInput(
            fmt::format("{}: the map gives {} names, but there are {} points. Name them all, in their "
                        "order.",
                        file, map.names.size(), recording.points.size()));
    for (std::size_t p = 0; p < map.names.size(); ++p) recording.points[p].name = map.names[p];
}

RecordedChannel in_our_units(const std::string& name, const std::string& unit, Eigen::VectorXd values) {
    if (const auto known = unit_in_ours(unit)) return {name, known->name, std::move(values) * known->factor};
    return {name, unit, std::move(values)};
}

}  // namespace palpate::identify
