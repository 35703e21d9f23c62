#include "identify/measurements/files/path_inside.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/topology/check_surface.h"
#include "mesh/topology/weld.h"

namespace palpate::identify {

std::filesystem::path path_inside(const mesh::YamlFields& fields, const std::string& key,
                                  const std::filesystem::path& folder) {
    const std::filesystem::path path = fields.text(key);
    const bool climbs = std::ranges::find(path, std::filesystem::path("..")) != path.end();
    if (path.empty() || path.is_absolute() || climbs)
        throw InvalidInput(
            fmt::format("{}: '{}' leads out of the set's folder. Copy the file into the folder and name "
                        "it by its path there.",
                        fields.where(key), path.string()));
    if (!std::filesystem::is_regular_file(folder / path))
        throw IoError(fmt::format("{}: there is no file '{}'.", fields.where(key), (folder / path).string()));
    return folder / path;
}

void check_region_paths(const std::vector<mesh::YamlFields>& regions, const std::filesystem::path& folder) {
    for (const mesh::YamlFields& region : regions)
        if (region.has("points") && region.mapping("points").has("file"))
            path_inside(region.mapping("points"), "file", folder);
}

mesh::Surface read_closed_surface(const std::filesystem::path& file, double unit, const std::string& where,
                                  const std::string& what) {
    constexpr double same = 1e-6;  // of the diagonal: corners of STL triangles that are one vertex
    mesh::Surface read = mesh::read_surface(file);
    mesh::Surface surface = mesh::weld(read, same * mesh::bounding_box(read.vertices).diagonal()).surface;
    surface.vertices *= unit;
    const mesh::SurfaceReport report = mesh::check_surface(surface);
    if (!report.closed || report.volume == 0)
        throw InvalidInput(fmt::format(
            "{}: '{}' is not closed ({} open edges, {} edges of more than two triangles), and {} must be a "
            "closed surface. Close it; 'palpate check {} -o FOLDER' shows where it is open.",
            where, file.filename().string(), report.boundary_edges, report.non_manifold_edges, what, file.string()));
    if (!report.outward)
        for (auto triangle : surface.triangles.rowwise()) std::swap(triangle[1], triangle[2]);
    return surface;
}

mesh::Surface read_closed_surface(const mesh::YamlFields& fields, const std::string& key,
                                  const std::filesystem::path& folder, double unit, const std::string& what) {
    return read_closed_surface(path_inside(fields, key, folder), unit, fields.where(key), what);
}

}  // namespace palpate::identify
