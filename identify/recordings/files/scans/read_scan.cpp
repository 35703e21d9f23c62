#include "identify/recordings/files/scans/read_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/series.h"
#include "identify/recordings/files/text/cell.h"
#include "identify/recordings/files/text/decoding/open_text.h"
#include "mesh/errors.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/formats/vtk/vtk_data.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

/// Points of one instant, as the file holds them.
struct Scan {
    Points points{};         // (n x 3)
    Points displacements{};  // (n x 3), or empty
    std::vector<std::string> names{};
    std::optional<double> time{};
    std::string format;
};

Scan read_ply_scan(const std::string& bytes, const std::filesystem::path& file) {
    const mesh::Polygons polygons = mesh::read_ply(bytes, file);
    Scan scan{.format = "PLY, points"};
    scan.points.resize(static_cast<Eigen::Index>(polygons.points.size()), 3);
    for (std::size_t p = 0; p < polygons.points.size(); ++p)
        scan.points.row(static_cast<Eigen::Index>(p)) = polygons.points[p].transpose();
    return scan;
}

Scan read_vtk_scan(const std::string& bytes, const std::filesystem::path& file) {
    const std::string_view head = std::string_view(bytes).substr(0, 1024);
    const auto kind = head.starts_with("# vtk")                             ? mesh::VtkKind::legacy
                      : head.find("\"PolyData\"") != std::string_view::npos ? mesh::VtkKind::poly_data
                                                                            : mesh::VtkKind::unstructured_grid;
    mesh::VtkData data = mesh::read_vtk(file, kind);
    Scan scan{.points = std::move(data.points), .format = "VTK, points"};
    for (const mesh::DataArray& array : data.of_points) {
        const std::string name = lower_case(array.name.substr(0, array.name.find(' ')));
        const bool is_displacement = name == "displacement" || name == "displacements" || name == "u" || name == "disp";
        if (is_displacement && array.values.cols() == 3) scan.displacements = array.values;
        const bool is_name =
            name == "id" || name == "ids" || name == "pointid" || name == "point_id" || name == "globalids";
        if (!is_name || array.values.cols() != 1) continue;
        scan.names.clear();
        for (const double id : array.values.reshaped()) scan.names.push_back(fmt::format("{}", id));
    }
    for (const mesh::DataArray& array : data.of_file)
        if (lower_case(array.name) == "timevalue" && array.values.size() > 0) scan.time = array.values(0, 0);
    return scan;
}

Recording recording_of(const Scan& scan, const std::filesystem::path& file, const FileMap& map) {
    const std::string name = file.filename().string();
    Recording recording = begun(name, scan.format);
    if (scan.points.rows() == 0) throw InvalidInput(fmt::format("{}: holds no points. Export it again.", name));
    const double factor = position_factor(map, "", name, recording);
    const bool has_displacements = scan.displacements.rows() == scan.points.rows();
    for (Eigen::Index p = 0; p < scan.points.rows(); ++p) {
        RecordedPoint point{scan.names.empty() ? fmt::format("{}", p + 1) : scan.names[static_cast<std::size_t>(p)],
                            factor * scan.points.row(p).transpose(),
                            {}};
        if (has_displacements) {
            point.displacement = factor * scan.displacements.row(p).transpose();
            point.at += point.displacement;
        }
        const bool is_usable = point.at.allFinite() && point.at.cwiseAbs().maxCoeff() < mesh::beyond_all_units;
        if (!is_usable) point.at.setConstant(not_seen);
        recording.points.push_back(std::move(point));
    }
    recording.times = Eigen::VectorXd::Constant(1, scan.time.value_or(0));
    recording.has_clock = scan.time.has_value();
    if (has_displacements)
        recording.notes.emplace_back("points are those at rest: positions are these and the displacements");
    recording.notes.emplace_back(scan.names.empty() ? "points are named by their order"
                                                    : "points are named by their id");
    name_points(map, name, recording);
    return recording;
}

bool is_series_file(const std::string& bytes) {
    const std::string_view head = std::string_view(bytes).substr(0, 1024);
    return head.find("<VTKFile") != head.npos && head.find("\"Collection\"") != head.npos;
}

Recording read_one_scan(const std::string& bytes, const std::filesystem::path& file, const FileMap& map) {
    return recording_of(bytes.starts_with("ply") ? read_ply_scan(bytes, file) : read_vtk_scan(bytes, file), file, map);
}

/// The value of an attribute in a tag: `file="a.vtu"`; "": there is none.
std::string attribute(std::string_view tag, const std::string& name) {
    const std::size_t at = tag.find(name + "=\"");
    if (at == tag.npos) return {};
    const std::string_view value = tag.substr(at + name.size() + 2);
    return std::string(value.substr(0, value.find('"')));
}

Recording read_series_file(const std::string& bytes, const std::filesystem::path& file, const FileMap& map) {
    const std::string name = file.filename().string();
    std::vector<Recording> frames;
    std::vector<double> times;
    for (std::size_t at = bytes.find("<DataSet"); at != bytes.npos; at = bytes.find("<DataSet", at + 1)) {
        const std::string_view tag = std::string_view(bytes).substr(at, bytes.find('>', at) - at);
        const std::filesystem::path path = file_beside(file, attribute(tag, "file"));
        const std::string content = mesh::read_text(path);
        if (is_series_file(content))
            throw InvalidInput(fmt::format("{}: the file {} is a series itself. Name the files of its frames.", name,
                                           path.filename().string()));
        frames.push_back(read_one_scan(content, path, map));
        times.push_back(mesh::parse_number(attribute(tag, "timestep")).value_or(not_seen));
    }
    if (frames.empty())
        throw InvalidInput(fmt::format("{}: a series that names no file (<DataSet file=...>). Write it again.", name));
    Recording recording = joined_frames(std::move(frames), name, map);
    const Eigen::Map<const Eigen::VectorXd> told(times.data(), static_cast<Eigen::Index>(times.size()));
    if (!map.rate && told.allFinite() && std::ranges::is_sorted(times)) {
        recording.times = told;
        recording.has_clock = true;
    }
    return recording;
}

}  // namespace

bool is_scan(const std::string& bytes) {
    const std::string_view head = std::string_view(bytes).substr(0, 1024);
    return head.starts_with("ply\n") || head.starts_with("ply\r") || head.starts_with("# vtk DataFile") ||
           head.find("<VTKFile") != std::string_view::npos;
}

Recording read_scan(const std::string& bytes, const std::filesystem::path& file, const FileMap& map) {
    return is_series_file(bytes) ? read_series_file(bytes, file, map) : read_one_scan(bytes, file, map);
}

}  // namespace palpate::identify
