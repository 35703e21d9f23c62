#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>

#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/mocap/frame_times.h"
#include "identify/recordings/files/mocap/mocap_files.h"
#include "identify/recordings/files/text/number_rows.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

/// The lines above the frames: what each column is of, and which coordinate.
struct MotiveHead {
    int axes = -1, quantities = -1, types = -1, names = -1;  // lines from 0; -1: there is none
};

MotiveHead head_of(const TextFile& text) {
    MotiveHead head;
    constexpr int most = 20;  // lines of the head
    for (int i = 1; i < std::min(text.lines(), most) && head.axes < 0; ++i) {
        const auto cells = text.cells(i);
        const std::string first = lower_case(cells[0]), second = cells.size() > 1 ? lower_case(cells[1]) : "";
        if (second == "type") head.types = i;
        if (second == "name") head.names = i;
        if (first == "frame" && second.starts_with("time")) head.axes = i;
    }
    head.quantities = head.axes - 1;
    if (head.axes < 0 || head.types < 0 || head.names < 0)
        throw InvalidInput(
            fmt::format("{}: the lines 'Type', 'Name' and 'Frame, Time' are needed above the frames, as "
                        "Motive 1.10 and later write them. Export the take again, with its header "
                        "information.",
                        text.file().filename().string()));
    return head;
}

/// Three neighbouring columns of one marker.
struct MarkerColumns {
    std::string type;
    std::array<int, 3> at{-1, -1, -1};
    bool is_complete() const { return at[0] >= 0 && at[1] >= 0 && at[2] >= 0; }
};

/// By name, in the order of the file; of one name the measured marker goes before the solved one.
struct Markers {
    std::vector<std::string> order;
    std::map<std::string, MarkerColumns> columns;
    std::set<std::string> left_out;  // types of columns that are no markers
};

/// @param takes_bodies pivots of rigid bodies, too
Markers markers_in(const TextFile& text, const MotiveHead& head, bool takes_bodies) {
    const auto types = text.cells(head.types), names = text.cells(head.names), quantities = text.cells(head.quantities),
               axes = text.cells(head.axes);
    const auto cell = [](const std::vector<std::string_view>& cells, std::size_t c) {
        return c < cells.size() ? cells[c] : std::string_view();
    };
    Markers markers;
    for (std::size_t c = 2; c < axes.size(); ++c) {
        const std::string type = lower_case(cell(types, c)), axis = lower_case(axes[c]);
        const bool is_body = type == "rigid body";
        const bool is_marker = type == "marker" || type == "rigid body marker" || type == "bone marker" ||
                               type == "skeleton marker" || type == "asset marker";
        if (!is_marker && !(is_body && takes_bodies)) {
            markers.left_out.insert(std::string(cell(types, c)));
            continue;
        }
        if (lower_case(cell(quantities, c)) != "position" || axis.size() != 1 || axis[0] < 'x' || axis[0] > 'z')
            continue;
        const std::string name(cell(names, c));
        auto [found, is_new] = markers.columns.try_emplace(name, MarkerColumns{.type = type});
        if (is_new) markers.order.push_back(name);
        if (found->second.type != "marker" && type == "marker") found->second = MarkerColumns{.type = type};
        int& place = found->second.at[static_cast<std::size_t>(axis[0] - 'x')];
        if (found->second.type == type && place < 0) place = static_cast<int>(c);
    }
    return markers;
}

/// The first line: names and values in turn.
std::map<std::string, std::string> motive_settings(const TextFile& text) {
    std::map<std::string, std::string> settings;
    const auto cells = text.cells(0);
    for (std::size_t c = 0; c + 1 < cells.size(); c += 2) settings[lower_case(cells[c])] = std::string(cells[c + 1]);
    return settings;
}

}  // namespace

bool is_motive(const TextFile& text) {
    return text.lines() > 0 && lower_case(trimmed(text.line(0))).find("format version") < 4;
}

Recording read_motive(const TextFile& text, const FileMap& map) {
    const std::string file = text.file().filename().string();
    const MotiveHead head = head_of(text);
    Markers markers = markers_in(text, head, false);
    const bool has_bodies_alone = markers.order.empty();
    if (has_bodies_alone) markers = markers_in(text, head, true);
    auto settings = motive_settings(text);
    std::vector<std::string> columns;
    std::vector<char> are_texts;
    for (const std::string_view cell : text.cells(head.axes)) {
        columns.emplace_back(cell);
        are_texts.push_back(lower_case(cell) == "timecode");  // of 1.24 and later: 15:26:46:12.02
    }
    const NumberRows rows = read_number_rows(text, head.axes + 1, text.lines(), columns, are_texts);
    if (rows.lines.empty()) throw InvalidInput(fmt::format("{}: holds no frame. Export the take again.", file));

    Recording recording = begun(file, "OptiTrack Motive, CSV");
    recording.notes = text.notes();
    const double factor = position_factor(map, settings["length units"], file, recording);
    for (const std::string& name : markers.order) {
        const MarkerColumns& marker = markers.columns.at(name);
        if (!marker.is_complete()) continue;
        RecordedPoint point{name, Eigen::Matrix3Xd(3, rows.values.rows()), {}};
        for (int k = 0; k < 3; ++k)
            point.at.row(k) = factor * rows.values.col(marker.at[static_cast<std::size_t>(k)]).transpose();
        drop_partly_seen(point.at);
        recording.points.push_back(std::move(point));
    }
    if (recording.points.empty())
        throw InvalidInput(fmt::format(
            "{}: holds no markers, but {}. Export the take again, with markers.", file,
            markers.left_out.empty() ? "no column at all" : fmt::format("{}", fmt::join(markers.left_out, ", "))));
    set_frame_times(text, rows, map, recording);
    if (has_bodies_alone)
        recording.notes.emplace_back("no markers: points are the pivots of rigid bodies, whose turns are left out");
    for (const std::string& type : markers.left_out)
        if (!type.empty()) recording.notes.push_back(fmt::format("columns of type {}: left out", mesh::cited(type)));
    if (!settings["coordinate space"].empty() && lower_case(settings["coordinate space"]) != "global")
        recording.notes.push_back(fmt::format("coordinate space is {}", mesh::cited(settings["coordinate space"])));
    name_points(map, file, recording);
    return recording;
}

}  // namespace palpate::identify
