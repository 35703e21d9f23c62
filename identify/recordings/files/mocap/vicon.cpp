#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/mocap/mocap_files.h"
#include "identify/recordings/files/text/number_rows.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

constexpr std::array sections{"trajectories", "devices", "model outputs", "joints", "segments", "events"};

/// The section that a line begins; "": none.
std::string section_at(const TextFile& text, int line) {
    const auto cells = text.cells(line);
    if (cells.empty()) return {};
    const std::string name = lower_case(cells[0]);
    const bool is_alone =
        std::all_of(cells.begin() + 1, cells.end(), [](std::string_view cell) { return cell.empty(); });
    return is_alone && std::ranges::find(sections, name) != sections.end() ? name : "";
}

/// A section: its name, its rate, three lines of names, axes and units, then rows.
struct ViconSection {
    std::string name;
    double rate = 0;
    std::vector<std::string> names{}, axes{}, units{};  // of each column; names stand above the first of their columns
    NumberRows rows{};
};

std::vector<std::string> texts_of(const TextFile& text, int line, std::size_t width) {
    std::vector<std::string> texts;
    for (const std::string_view cell : text.cells(line)) texts.emplace_back(cell);
    texts.resize(std::max(width, texts.size()));
    return texts;
}

ViconSection read_section(const TextFile& text, int begin, int end, const FileMap& map) {
    ViconSection section{.name = section_at(text, begin)};
    if (begin + 5 >= end)
        throw InvalidInput(
            fmt::format("{}: the section {} is cut off: a rate, three lines of names and its rows are needed. "
                        "Export the file again.",
                        text.where(begin), mesh::cited(section.name)));
    const CellValue rate = value_of(text.cells(begin + 1)[0], text.dialect());
    if (map.rate && section.name != "devices")
        section.rate = *map.rate;
    else if (rate.kind == CellValue::Kind::number && rate.value > 0)
        section.rate = rate.value;
    else
        throw InvalidInput(
            fmt::format("{}: {} stands for the rate of the section; a number above 0 is needed. Mend it, or "
                        "export the file again.",
                        text.where(begin + 1), mesh::cited(text.line(begin + 1))));
    section.axes = texts_of(text, begin + 3, 0);
    while (!section.axes.empty() && section.axes.back().empty()) section.axes.pop_back();
    if (section.axes.size() < 3 || lower_case(section.axes[0]) != "frame" ||
        !lower_case(section.axes[1]).starts_with("sub"))
        throw InvalidInput(
            fmt::format("{}: 'Frame, Sub Frame' and the names of columns are needed here. Export the file "
                        "again.",
                        text.where(begin + 3)));
    section.names = texts_of(text, begin + 2, section.axes.size());
    section.units = texts_of(text, begin + 4, section.axes.size());
    for (std::size_t c = 3; c < section.axes.size(); ++c)
        if (section.names[c].empty()) section.names[c] = section.names[c - 1];
    section.rows = read_number_rows(text, begin + 5, end, section.axes);
    if (section.rows.lines.empty())
        throw InvalidInput(fmt::format("{}: the section {} holds no rows. Export the file again.", text.where(begin),
                                       mesh::cited(section.name)));
    return section;
}

/// Frames count from 1, at the rate of the cameras; a section's rate is that of its sub frames.
void set_section_clock(const ViconSection& section, const TextFile& text, Recording& recording) {
    const auto& values = section.rows.values;
    double most = 0;
    for (Eigen::Index r = 0; r < values.rows(); ++r) {
        if (!std::isfinite(values(r, 0)) || !std::isfinite(values(r, 1)))
            throw InvalidInput(fmt::format("{}: the frame's number is missing. Complete the line, or remove it.",
                                           text.where(section.rows.lines[static_cast<std::size_t>(r)])));
        most = std::max(most, values(r, 1));
    }
    recording.times = ((values.col(0).array() - 1) * (most + 1) + values.col(1).array()) / section.rate;
    recording.has_clock = true;
    for (Eigen::Index r = 1; r < values.rows(); ++r)
        if (recording.times[r] <= recording.times[r - 1])
            throw InvalidInput(fmt::format("{}: frames run backwards, from {} to {}. Export the file again.",
                                           text.where(section.rows.lines[static_cast<std::size_t>(r)]),
                                           values(r - 1, 0), values(r, 0)));
}

void add_points(const ViconSection& section, const FileMap& map, const std::string& file, Recording& recording) {
    const double factor = position_factor(map, section.units[2], file, recording);
    const auto width = static_cast<Eigen::Index>(section.axes.size());
    for (Eigen::Index c = 2; c + 2 < width; ++c) {
        const auto axis = [&](Eigen::Index k) { return lower_case(section.axes[static_cast<std::size_t>(c + k)]); };
        if (axis(0) != "x" || axis(1) != "y" || axis(2) != "z") continue;  // X' and the like are velocities
        RecordedPoint point{
            section.names[static_cast<std::size_t>(c)], factor * section.rows.values.middleCols(c, 3).transpose(), {}};
        drop_partly_seen(point.at);
        recording.points.push_back(std::move(point));
        c += 2;
    }
    if (recording.points.empty())
        throw InvalidInput(fmt::format("{}: its trajectories have no columns X, Y, Z. Export the file again.", file));
    name_points(map, file, recording);
}

void add_channels(const ViconSection& section, Recording& recording) {
    for (std::size_t c = 2; c < section.axes.size(); ++c)
        recording.channels.push_back(
            in_our_units(section.names[c].empty() ? section.axes[c] : section.names[c] + " " + section.axes[c],
                         section.units[c], section.rows.values.col(static_cast<Eigen::Index>(c))));
}

/// Subject, context, name, time: a line each, below a line of names.
std::vector<RecordedEvent> events_in(const TextFile& text, int begin, int end) {
    std::vector<RecordedEvent> events;
    for (int i = begin + 3; i < end; ++i) {
        const auto cells = text.cells(i);
        if (cells.size() < 4) continue;
        const CellValue time = value_of(cells[3], text.dialect());
        if (time.kind == CellValue::Kind::number)
            events.push_back({fmt::format("{}{}{}", cells[1], cells[1].empty() ? "" : " ", cells[2]), time.value});
    }
    return events;
}

}  // namespace

bool is_vicon(const TextFile& text) {
    for (int i = 0; i < text.lines(); ++i)
        if (!trimmed(text.line(i)).empty()) return !section_at(text, i).empty();
    return false;
}

std::vector<Recording> read_vicon(const TextFile& text, const FileMap& map) {
    const std::string file = text.file().filename().string();
    std::vector<int> begins;
    for (int i = 0; i < text.lines(); ++i)
        if (!section_at(text, i).empty()) begins.push_back(i);
    begins.push_back(text.lines());

    std::vector<Recording> recordings;
    std::vector<RecordedEvent> events;
    std::vector<std::string> left_out;
    for (std::size_t s = 0; s + 1 < begins.size(); ++s) {
        const std::string name = section_at(text, begins[s]);
        if (name == "events") {
            events = events_in(text, begins[s], begins[s + 1]);
            continue;
        }
        if (name == "joints" || name == "segments") {
            left_out.push_back(name);
            continue;
        }
        const ViconSection section = read_section(text, begins[s], begins[s + 1], map);
        const bool is_points = name == "trajectories";
        Recording recording = begun(is_points ? file : file + ", " + name, "Vicon, " + name);
        recording.notes = text.notes();
        if (is_points)
            add_points(section, map, file, recording);
        else
            add_channels(section, recording);
        set_section_clock(section, text, recording);
        // Points first: others are read beside them.
        recordings.insert(is_points ? recordings.begin() : recordings.end(), std::move(recording));
    }
    if (recordings.empty())
        throw InvalidInput(
            fmt::format("{}: holds neither trajectories, nor devices, nor model outputs. Export it again, with "
                        "them.",
                        file));
    recordings[0].events = std::move(events);
    for (const std::string& name : left_out) recordings[0].notes.push_back(fmt::format("{}: left out", name));
    return recordings;
}

}  // namespace palpate::identify
