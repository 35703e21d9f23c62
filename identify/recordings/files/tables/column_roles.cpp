#include "identify/recordings/files/tables/column_roles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "identify/recordings/files/units.h"

namespace palpate::identify {
namespace {

bool is_one_of(const std::string& word, const std::vector<std::string>& words) {
    return std::ranges::find(words, word) != words.end();
}

bool is_time_name(const std::string& name) {
    static const std::vector<std::string> names{"time",
                                                "t",
                                                "zeit",
                                                "pr\xC3\xBC"
                                                "fzeit",
                                                "testzeit",
                                                "timestamp",
                                                "time stamp",
                                                "elapsed time",
                                                "total time",
                                                "test time",
                                                "running time",
                                                "time_s",
                                                "t_s",
                                                "seconds",
                                                "temps",
                                                "tiempo",
                                                "tempo",
                                                "sec",
                                                "elapsed",
                                                "zeitpunkt",
                                                "date/time",
                                                "datetime"};
    return is_one_of(lower_case(name), names);
}

bool is_counter_name(const std::string& name) {
    static const std::vector<std::string> names{"frame", "frames", "frame#", "frame number", "sample", "samples",
                                                "index", "idx",    "point",  "no",           "no.",    "nr",
                                                "nr.",   "row",    "count",  "step",         "scan",   "record",
                                                "image", "bild",   "field",  "field#",       "#",      "sub frame"};
    return is_one_of(lower_case(name), names);
}

/// Names of vectors that are no positions: "Fx", "moment_y", "acc.z", "rot_x".
bool is_other_vector(const std::string& point) {
    static const std::vector<std::string> names{
        "f",     "force",    "forces", "moment",       "moments",  "torque",      "acc",        "gyro",   "mag",
        "vel",   "velocity", "rot",    "acceleration", "rotation", "orientation", "quaternion", "quat",   "q",
        "angle", "euler",    "omega",  "linear",       "angular",  "wrench",      "kraft",      "strain", "stress",
        "load",  "normal",   "std",    "sigma",        "error",    "err",         "covariance", "eps",    "epsilon"};
    // The last word counts: "imu.linear_acceleration", "F 2".
    std::string bare = lower_case(point);
    bare.erase(bare.find_last_not_of("0123456789_ .:-/") + 1);
    bare = bare.substr(bare.find_last_of("_ .:-/") + 1);
    return is_one_of(bare, names);
}

bool is_length_or_untold(const NumberColumn& column) {
    if (column.unit.empty() || lower_case(column.unit) == "pixel" || lower_case(column.unit) == "px") return true;
    const auto unit = unit_in_ours(column.unit);
    return unit && unit->name == "mm";
}

bool is_time_unit(const NumberColumn& column) {
    const auto unit = unit_in_ours(column.unit);
    return unit && unit->name == "s";
}

/// "ElapsedTime", "Zeit ab Start": values of such a name that rise are times.
bool is_rising_time(const NumberColumn& column) {
    const std::string name = lower_case(column.name);
    if (column.is_text || (name.find("time") == name.npos && name.find("zeit") == name.npos)) return false;
    const Eigen::Index n = column.values.size();
    return n > 1 && column.values.allFinite() && column.values[n - 1] > column.values[0] &&
           std::is_sorted(column.values.begin(), column.values.end());
}

bool is_counter(const Eigen::VectorXd& values) {
    if (values.size() < 2 || !values.allFinite()) return false;
    const double first = values[0];
    return first == std::floor(first) &&
           (values - Eigen::VectorXd::LinSpaced(values.size(), first, first + static_cast<double>(values.size() - 1)))
                   .cwiseAbs()
                   .maxCoeff() == 0;
}

/// A column that numbers the rows: by its name, or the first one, whatever its name.
bool is_counter_column(const NumberTable& table, std::size_t c) {
    const NumberColumn& column = table.columns[c];
    if (column.is_text || !is_counter(column.values)) return false;
    constexpr Eigen::Index enough = 3;  // rows that rise by 1 by chance are fewer
    const bool is_first = c == 0 && table.columns.size() > 1 && table.rows() >= enough && column.unit.empty();
    return is_first || column.name.empty() || is_counter_name(column.name);
}

/// Points whose coordinates have names.
void find_points(const NumberTable& table, std::vector<char>& used, ColumnRoles& roles) {
    std::vector<std::string> order;
    std::map<std::string, PointColumns> points;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        const NumberColumn& column = table.columns[c];
        if (used[c] || column.is_text || !is_length_or_untold(column)) continue;
        const CoordinateName name = coordinate_in(column.name);
        if (name.axis < 0 || is_other_vector(name.point)) continue;
        auto [point, is_new] = points.try_emplace(name.point, PointColumns{.name = name.point});
        if (is_new) order.push_back(name.point);
        int& place = point->second.at[static_cast<std::size_t>(name.axis)];
        if (place >= 0) return;  // names that come twice tell nothing
        place = static_cast<int>(c);
    }
    for (const std::string& name : order) {
        const PointColumns& point = points.at(name);
        if (point.at[0] < 0 || point.at[1] < 0) continue;
        for (const int c : point.at)
            if (c >= 0) used[static_cast<std::size_t>(c)] = 1;
        // "C7[3]" beside "C7[0]" to "C7[2]": the 1 of homogeneous coordinates
        for (std::size_t c = 0; c < used.size(); ++c)
            if (!name.empty() && table.columns[c].name == name + "[3]") used[c] = 1;
        roles.points.push_back(point);
        if (roles.points.back().name.empty()) roles.points.back().name = "1";
    }
}

/// Without names: a counter, a clock, then points in threes.
void guess_by_numbers(const NumberTable& table, std::vector<char>& used, ColumnRoles& roles) {
    const auto take = [&](int c) { used[static_cast<std::size_t>(c)] = 1; };
    const auto columns = static_cast<int>(table.columns.size());
    if (columns < 2) return;
    int next = 0;
    if (is_counter(table.columns[0].values)) {
        roles.frame = next++;
        take(0);
        roles.notes.emplace_back("column 1 counts the rows");
    }
    if (next < columns && is_steady(table.columns[static_cast<std::size_t>(next)].values)) {
        roles.time = next;
        take(next++);
        roles.notes.push_back(fmt::format("column {} rises steadily: taken for the time in s", next));
    }
    const int left = columns - next;
    if (left < 3 || left % 3 != 0) return;
    for (int c = next; c + 2 < columns; c += 3) {
        roles.points.push_back({.name = fmt::format("{}", (c - next) / 3 + 1), .at = {c, c + 1, c + 2}});
        for (int k = c; k < c + 3; ++k) take(k);
    }
    roles.notes.push_back(
        fmt::format("the other {} columns are taken for x, y, z of {} points; a map tells otherwise", left, left / 3));
}

}  // namespace

bool is_steady(const Eigen::VectorXd& values) {
    constexpr double rounding = 0.2;  // of a step: clocks are written with few digits
    const Eigen::Index n = values.size();
    if (n < 3 || !values.allFinite()) return false;
    const double step = (values[n - 1] - values[0]) / static_cast<double>(n - 1);
    if (!(step > 0)) return false;
    const Eigen::VectorXd steps = values.tail(n - 1) - values.head(n - 1);
    return ((steps.array() - step).abs() <= rounding * step).all();
}

CoordinateName coordinate_in(const std::string& name) {
    const auto axis_of = [](char c) {
        const char letter = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        return letter >= 'x' && letter <= 'z' ? letter - 'x' : -1;
    };
    const auto is_separator = [](char c) {
        return c == '_' || c == ' ' || c == '.' || c == ':' || c == '-' || c == '/';
    };
    const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    const auto without_separators = [&](std::string text) {
        while (!text.empty() && is_separator(text.back())) text.pop_back();
        while (!text.empty() && is_separator(text.front())) text.erase(0, 1);
        return text;
    };
    if (name.empty()) return {};
    if (name.ends_with(']') && name.size() > 3 && name[name.size() - 3] == '[' && is_digit(name[name.size() - 2])) {
        const int component = name[name.size() - 2] - '0';
        return {name.substr(0, name.size() - 3), component < 3 ? component : -1};
    }
    if (name.size() == 1) return {"", axis_of(name[0])};
    const char before = name[name.size() - 2];
    // "tip-px" beside "tip-qx", of a pose
    const bool is_of_position =
        name.size() > 3 && (before == 'p' || before == 'P') && is_separator(name[name.size() - 3]);
    if (axis_of(name.back()) >= 0 && is_of_position)
        return {without_separators(name.substr(0, name.size() - 2)), axis_of(name.back())};
    if (axis_of(name.back()) >= 0 && (is_separator(before) || is_digit(before)))
        return {without_separators(name.substr(0, name.size() - 1)), axis_of(name.back())};
    // "M1X" above, "tipX" here: a change of case separates too
    const bool is_changed_case = std::islower(static_cast<unsigned char>(before)) != 0 && name.back() <= 'Z';
    if (axis_of(name.back()) >= 0 && is_changed_case) return {name.substr(0, name.size() - 1), axis_of(name.back())};
    if (axis_of(name[0]) >= 0 && (is_separator(name[1]) || is_digit(name[1])))
        return {without_separators(name.substr(1)), axis_of(name[0])};
    return {};
}

ColumnRoles roles_of(const NumberTable& table) {
    ColumnRoles roles;
    std::vector<char> used(table.columns.size());
    for (std::size_t c = 0; c < table.columns.size() && table.has_names; ++c) {
        const NumberColumn& column = table.columns[c];
        const bool is_time =
            is_time_name(column.name) || is_rising_time(column) || (c == 0 && is_time_unit(column) && !column.is_text);
        if (roles.time < 0 && is_time) {
            roles.time = static_cast<int>(c);
            used[c] = 1;
        } else if (is_counter_column(table, c)) {
            if (roles.frame < 0) roles.frame = static_cast<int>(c);
            used[c] = 1;
        }
    }
    if (table.has_names)
        find_points(table, used, roles);
    else
        guess_by_numbers(table, used, roles);
    for (std::size_t c = 0; c < table.columns.size(); ++c)
        if (!used[c] && !table.columns[c].is_text && !table.columns[c].values.array().isNaN().all())
            roles.channels.push_back(static_cast<int>(c));
    return roles;
}

}  // namespace palpate::identify
