#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>

#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/mocap/frame_times.h"
#include "identify/recordings/files/mocap/mocap_files.h"
#include "identify/recordings/files/text/number_rows.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

/// Cells with something in them: some programs separate by two tabs.
std::vector<std::string_view> filled_cells(const TextFile& text, int line) {
    std::vector<std::string_view> cells = text.cells(line);
    std::erase_if(cells, [](std::string_view cell) { return cell.empty(); });
    return cells;
}

/// The two lines of settings: names above values.
std::map<std::string, std::string> settings_of(const TextFile& text) {
    const auto names = filled_cells(text, 1), values = filled_cells(text, 2);
    std::map<std::string, std::string> settings;
    for (std::size_t c = 0; c < std::min(names.size(), values.size()); ++c)
        settings[lower_case(names[c])] = std::string(values[c]);
    return settings;
}

/// Names of markers: each stands above three columns, behind the number and the time of a frame.
std::vector<std::string> markers_of(const TextFile& text) {
    std::vector<std::string> markers;
    const auto cells = text.cells(3);
    for (std::size_t c = 2; c < cells.size(); ++c)
        if (!cells[c].empty()) markers.emplace_back(cells[c]);
    return markers;
}

}  // namespace

bool is_trc(const TextFile& text) { return text.lines() > 0 && trimmed(text.line(0)).starts_with("PathFileType"); }

Recording read_trc(const TextFile& text, const FileMap& map) {
    const std::string file = text.file().filename().string();
    constexpr int head = 5;  // lines: type, settings' names, settings, markers, coordinates
    if (text.lines() <= head)
        throw InvalidInput(
            fmt::format("{}: a TRC file begins with {} lines of its own, and has frames below. It is cut off: "
                        "export it again.",
                        file, head));
    const auto settings = settings_of(text);
    const auto setting = [&](const char* name) {
        const auto found = settings.find(name);
        return found == settings.end() ? std::string() : found->second;
    };
    const std::vector<std::string> markers = markers_of(text);
    if (markers.empty()) throw InvalidInput(fmt::format("{}: line 4 names no markers. Export the file again.", file));
    if (const auto told = mesh::parse_integer(setting("nummarkers")); told && *told != static_cast<int>(markers.size()))
        throw InvalidInput(fmt::format("{}: line 3 tells {} markers, line 4 names {}. Mend one of them.", file, *told,
                                       markers.size()));
    std::vector<std::string> columns{"Frame#", "Time"};
    for (const std::string& marker : markers)
        for (const char* axis : {" x", " y", " z"}) columns.push_back(marker + axis);

    const NumberRows rows = read_number_rows(text, head, text.lines(), columns);
    if (rows.lines.empty()) throw InvalidInput(fmt::format("{}: holds no frame. Export it again.", file));
    Recording recording = begun(file, "TRC, motion capture");
    recording.notes = text.notes();
    const double factor = position_factor(map, setting("units"), file, recording);
    for (std::size_t m = 0; m < markers.size(); ++m) {
        RecordedPoint point{
            markers[m], factor * rows.values.middleCols(static_cast<Eigen::Index>(2 + 3 * m), 3).transpose(), {}};
        drop_partly_seen(point.at);
        recording.points.push_back(std::move(point));
    }
    set_frame_times(text, rows, map, recording);
    if (const auto told = mesh::parse_integer(setting("numframes")); told && *told != rows.values.rows())
        recording.notes.push_back(fmt::format("line 3 tells {} frames, {} are there", *told, rows.values.rows()));
    name_points(map, file, recording);
    return recording;
}

}  // namespace palpate::identify
