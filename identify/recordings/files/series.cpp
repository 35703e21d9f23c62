#include "identify/recordings/files/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/text/cell.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;

bool is_decimal_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// What stands before and after the '*', or a number, of a name.
struct NameParts {
    std::string before, after;
};

/// Around each number of a name, the last one first.
std::vector<NameParts> around_numbers(const std::string& name) {
    std::vector<NameParts> parts;
    std::size_t end = name.rfind('.') == name.npos ? name.size() : name.rfind('.');
    while (true) {
        while (end > 0 && !is_decimal_digit(name[end - 1])) --end;
        if (end == 0) return parts;
        std::size_t begin = end;
        while (begin > 0 && is_decimal_digit(name[begin - 1])) --begin;
        parts.push_back({name.substr(0, begin), name.substr(end)});
        end = begin;
    }
}

/// Files of a folder whose names begin and end so; in between whatever, or a number.
std::vector<fs::path> files_between(const fs::path& folder, const NameParts& parts, bool is_number) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_regular_file() || name.starts_with('.')) continue;
        const bool fits = name.size() >= parts.before.size() + parts.after.size() && name.starts_with(parts.before) &&
                          name.ends_with(parts.after);
        if (!fits) continue;
        const std::string middle =
            name.substr(parts.before.size(), name.size() - parts.before.size() - parts.after.size());
        if (!is_number || (!middle.empty() && std::ranges::all_of(middle, is_decimal_digit)))
            files.push_back(entry.path());
    }
    return files;
}

/// Licences and notes, which published folders of data hold beside it.
bool accompanies_data(const fs::path& file) {
    const std::string name = lower_case(file.filename().string());
    constexpr std::array notes{"license", "licence", "copying", "readme", "citation", "changelog"};
    return name.ends_with(".md") ||
           std::ranges::any_of(notes, [&](const char* note) { return name.starts_with(note); });
}

/// Those that differ from this name in one number only: the last of its numbers in which any do.
std::vector<fs::path> numbered_alike(const fs::path& folder, const std::string& name) {
    for (const NameParts& parts : around_numbers(name))
        if (auto files = files_between(folder, parts, true); files.size() > 1) return files;
    throw InvalidInput(
        fmt::format("{}: 'series: true', but no file beside it differs from it in one number only. Name "
                    "the series with '*', or leave 'series' out.",
                    name));
}

/// Places at rest, by which points are known again: within half a cell of a grid, whichever cell they fall into.
class PlacesAtRest {
public:
    /// The index of a place that was met before, or `next`.
    std::size_t index_of(const Eigen::Vector3d& place, std::size_t next) {
        const Cell own = cell_of(place);
        for (const double x : {-1, 0, 1})
            for (const double y : {-1, 0, 1})
                for (const double z : {-1, 0, 1}) {
                    const auto found = places_.find({own[0] + x, own[1] + y, own[2] + z});
                    if (found != places_.end() && (found->second.place - place).cwiseAbs().maxCoeff() <= grid / 2)
                        return found->second.index;
                }
        places_.try_emplace(own, Known{place, next});
        return next;
    }

private:
    static constexpr double grid = 1e-4;  // [mm]; programs write coordinates to a micrometre or finer
    using Cell = std::array<double, 3>;
    struct Known {
        Eigen::Vector3d place;
        std::size_t index;
    };

    static Cell cell_of(const Eigen::Vector3d& place) {
        return {std::round(place[0] / grid), std::round(place[1] / grid), std::round(place[2] / grid)};
    }

    std::map<Cell, Known> places_;
};

/// Of each file: which of the joint points each of its own is.
struct JointPoints {
    std::vector<std::string> names;
    std::vector<std::vector<std::size_t>> index;  // (files) x (points of the file); `none` where it has no place
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
};

JointPoints by_rest(const std::vector<Recording>& frames) {
    JointPoints joint;
    PlacesAtRest places;
    for (const Recording& frame : frames) {
        auto& index = joint.index.emplace_back();
        for (const RecordedPoint& point : frame.points) {
            if (!point.at.col(0).allFinite()) {
                index.push_back(JointPoints::none);
                continue;
            }
            index.push_back(places.index_of(point.at.col(0) - point.displacement.col(0), joint.names.size()));
            if (index.back() == joint.names.size()) joint.names.push_back(fmt::format("{}", joint.names.size() + 1));
        }
    }
    return joint;
}

JointPoints by_name(const std::vector<Recording>& frames) {
    JointPoints joint;
    std::map<std::string, std::size_t> index_of;
    for (const Recording& frame : frames) {
        auto& index = joint.index.emplace_back();
        for (const RecordedPoint& point : frame.points) {
            const auto [found, is_new] = index_of.try_emplace(point.name, joint.names.size());
            if (is_new) joint.names.push_back(point.name);
            index.push_back(found->second);
        }
    }
    return joint;
}

bool are_named_by_order(const Recording& frame) {
    for (std::size_t p = 0; p < frame.points.size(); ++p)
        if (frame.points[p].name != fmt::format("{}", p + 1)) return false;
    return true;
}

JointPoints joint_points(const std::vector<Recording>& frames, std::vector<std::string>& notes) {
    const bool is_by_order = std::ranges::all_of(frames, are_named_by_order);
    if (!is_by_order) return by_name(frames);
    const bool has_displacements = std::ranges::all_of(frames, [](const Recording& frame) {
        return std::ranges::all_of(frame.points,
                                   [](const RecordedPoint& point) { return point.displacement.cols() > 0; });
    });
    if (has_displacements) {
        notes.emplace_back("points of the files are matched by their places at rest");
        return by_rest(frames);
    }
    for (const Recording& frame : frames)
        if (frame.points.size() != frames[0].points.size())
            throw InvalidInput(
                fmt::format("{} has {} points, {} has {}: points without names need the same order in each "
                            "file. Name them, or import the files apart.",
                            frame.source, frame.points.size(), frames[0].source, frames[0].points.size()));
    notes.emplace_back("points of the files are matched by their order");
    return by_name(frames);
}

}  // namespace

std::vector<fs::path> files_of_series(const fs::path& file, bool is_series) {
    const bool is_folder = fs::is_directory(file), has_star = file.filename().string().find('*') != std::string::npos;
    if (!is_folder && !has_star && !is_series) return {file};
    const fs::path folder = is_folder ? file : file.has_parent_path() ? file.parent_path() : fs::path(".");
    const std::string name = file.filename().string();
    const std::size_t star = name.find('*');
    std::vector<fs::path> files = is_folder ? files_between(folder, {}, false)
                                  : has_star
                                      ? files_between(folder, {name.substr(0, star), name.substr(star + 1)}, false)
                                      : numbered_alike(folder, name);
    if (is_folder) std::erase_if(files, accompanies_data);
    if (files.empty())
        throw IoError(fmt::format("{}: {}.", file.string(),
                                  is_folder ? "there are no files in this folder" : "there is no file of such a name"));
    std::ranges::sort(files, mesh::is_before_by_numbers, [](const fs::path& path) { return path.filename().string(); });
    return files;
}

Recording joined_frames(std::vector<Recording> frames, const std::string& source, const FileMap& map) {
    Recording recording = begun(source, frames[0].format + fmt::format(", a series of {} files", frames.size()));
    recording.notes = frames[0].notes;
    const JointPoints joint = joint_points(frames, recording.notes);
    Eigen::Index count = 0;
    for (const Recording& frame : frames) count += frame.times.size();
    constexpr double most_positions = 2e8;  // 10 GB
    if (static_cast<double>(count) * static_cast<double>(joint.names.size()) > most_positions)
        throw InvalidInput(
            fmt::format("{}: {} points in {} frames are too many. Are they the same points in each file? Export "
                        "fewer of them.",
                        source, joint.names.size(), count));
    const bool has_displacements = std::ranges::any_of(frames, [](const Recording& frame) {
        return !frame.points.empty() && frame.points[0].displacement.cols() > 0;
    });
    for (const std::string& name : joint.names) {
        recording.points.push_back({name, Eigen::Matrix3Xd::Constant(3, count, not_seen), {}});
        if (has_displacements) recording.points.back().displacement = Eigen::Matrix3Xd::Constant(3, count, not_seen);
    }
    Eigen::Index at = 0;
    for (std::size_t f = 0; f < frames.size(); ++f) {
        const Eigen::Index length = frames[f].times.size();
        for (std::size_t p = 0; p < frames[f].points.size(); ++p) {
            if (joint.index[f][p] == JointPoints::none) continue;
            RecordedPoint& point = recording.points[joint.index[f][p]];
            point.at.middleCols(at, length) = frames[f].points[p].at;
            if (frames[f].points[p].displacement.cols() > 0)
                point.displacement.middleCols(at, length) = frames[f].points[p].displacement;
        }
        at += length;
    }
    // The clock of the files where it goes on from file to file.
    Eigen::VectorXd times(count);
    bool goes_on = true;
    at = 0;
    for (const Recording& frame : frames) {
        times.segment(at, frame.times.size()) = frame.times;
        goes_on = goes_on && frame.has_clock && (at == 0 || frame.times[0] > times[at - 1]);
        at += frame.times.size();
    }
    if (map.rate) {
        set_rate(*map.rate, count, 0, recording);
    } else if (goes_on) {
        recording.times = times;
        recording.has_clock = true;
    } else {
        set_no_clock(count, recording);
    }
    if (std::ranges::any_of(frames, [](const Recording& frame) { return !frame.channels.empty(); }))
        recording.notes.emplace_back("channels of the files are left out");
    return recording;
}

}  // namespace palpate::identify
