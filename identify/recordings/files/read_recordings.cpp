#include "identify/recordings/files/read_recordings.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "identify/recordings/files/c3d/read_c3d.h"
#include "identify/recordings/files/draft_map.h"
#include "identify/recordings/files/exodus/read_exodus.h"
#include "identify/recordings/files/mat/read_mat.h"
#include "identify/recordings/files/mocap/mocap_files.h"
#include "identify/recordings/files/scans/read_scan.h"
#include "identify/recordings/files/series.h"
#include "identify/recordings/files/tables/table_recording.h"
#include "identify/recordings/files/text/decoding/open_text.h"
#include "identify/recordings/files/text/table_head.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;

/// Files that are not read, and what to do with them.
struct KnownOther {
    std::string_view begin;
    const char* advice;
};
constexpr KnownOther known_others[]{
    {"PK\x03\x04", "a spreadsheet or an archive (xlsx, ods, zip). Save the sheet as CSV, or unpack it"},
    {"\xD0\xCF\x11\xE0", "a spreadsheet or document of old Office. Save the sheet as CSV"},
    {"%PDF", "a PDF. Export the data as CSV"},
    {"\x1F\x8B", "packed by gzip. Unpack it"},
    {"solid ", "a surface (STL). A mesh at rest is no recording: give it as the set's body"},
    {"\x93NUMPY", "an array of NumPy. Write it as CSV (numpy.savetxt)"},
    {"TDSm", "a TDMS file of LabVIEW. Export it as CSV or TXT"},
    {"\x89PNG", "a picture"},
    {"\xFF\xD8\xFF", "a picture"}};

std::string map_to_start_from(const fs::path& file) { return "A map to start from:\n" + draft_map(file, {}); }

[[noreturn]] void refuse_binary(const fs::path& file, const std::string& bytes) {
    for (const KnownOther& other : known_others)
        if (bytes.starts_with(other.begin))
            throw InvalidInput(fmt::format("{}: this is {}.", file.filename().string(), other.advice));
    throw InvalidInput(
        fmt::format("{}: it is binary, and none of C3D, MATLAB (5 to 7.3), Exodus, PLY and VTK, which are read. Export "
                    "it as CSV or C3D.",
                    file.filename().string()));
}

std::vector<Recording> read_text_file(const TextFile& text, const FileMap& map) {
    const auto is = [&](const char* format, bool (*begins_so)(const TextFile&)) {
        return map.format == format || (map.format.empty() && begins_so(text));
    };
    if (is("trc", is_trc)) return {read_trc(text, map)};
    if (is("motive", is_motive)) return {read_motive(text, map)};
    if (is("vicon", is_vicon)) return read_vicon(text, map);
    try {
        return {read_table(text, map)};
    } catch (const NoTable& error) {
        throw InvalidInput(fmt::format(
            "{} Recognised: text ({}), {} lines. Not recognised: the beginning of TRC (PathFileType), Motive (Format "
            "Version) or Vicon (Trajectories, Devices), and rows of numbers. {}",
            error.what(), fmt::join(text.notes(), ", "), text.lines(), map_to_start_from(text.file())));
    }
}

std::vector<Recording> read_file(const fs::path& file, const FileMap& map) {
    if (map.sheets) return {read_sheets(file, map)};
    const std::string bytes = mesh::read_text(file);
    if (bytes.empty()) throw InvalidInput(fmt::format("{}: the file is empty.", file.filename().string()));
    const auto is = [&](const char* format, bool (*begins_so)(const std::string&)) {
        return map.format == format || (map.format.empty() && begins_so(bytes));
    };
    if (is("c3d", is_c3d)) return read_c3d(bytes, file, map);
    if (is("mat", is_mat)) return {read_mat(file, map)};
    if (is("exodus", is_exodus)) return {read_exodus(file, map)};
    if (is("scan", is_scan)) return {read_scan(bytes, file, map)};
    if (bytes.starts_with("solid ") && bytes.find("facet") != bytes.npos) refuse_binary(file, bytes);
    const auto text = try_text(file, bytes, map);
    if (!text) refuse_binary(file, bytes);
    return read_text_file(*text, map);
}

/// A table of which nothing can be used is none of ours.
void require_content(const std::vector<Recording>& recordings, const fs::path& file) {
    for (const Recording& recording : recordings)
        if (recording.points.empty() && recording.channels.empty())
            throw InvalidInput(fmt::format(
                "{}: recognised as {} ({}), but neither points nor channels are found in it. {}", recording.source,
                recording.format, fmt::join(recording.notes, "; "), map_to_start_from(file)));
}

}  // namespace

std::vector<Recording> read_recordings(const fs::path& file, const FileMap& map) {
    const std::vector<fs::path> files = files_of_series(file, map.series);
    std::vector<Recording> recordings;
    if (files.size() == 1 && !map.series) {
        recordings = read_file(files[0], map);
        require_content(recordings, files[0]);
        return recordings;
    }
    for (const fs::path& each : files) {
        std::vector<Recording> parts = read_file(each, map);
        if (parts[0].points.empty())
            throw InvalidInput(
                fmt::format("{}: a file of a series, but it holds no points. Name the files that do, as "
                            "'scan_*.ply'.",
                            each.filename().string()));
        recordings.push_back(std::move(parts[0]));
    }
    return {joined_frames(std::move(recordings), file.filename().string(), map)};
}

}  // namespace palpate::identify
