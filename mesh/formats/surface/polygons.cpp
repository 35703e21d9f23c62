#include "mesh/formats/surface/polygons.h"

#include <fmt/format.h>

#include <cmath>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

/// "liver.obj, line 12" or "liver.ply, face 12" (from 0), to begin a message with.
std::string where(const Polygons& polygons, std::size_t polygon, const std::filesystem::path& file) {
    return polygons.lines.empty() ? fmt::format("{}, face {} (from 0)", file.string(), polygon)
                                  : fmt::format("{}, line {}", file.string(), polygons.lines[polygon]);
}

// Cutting ears takes as many steps as the square of a face's corners: a second for the most that is allowed in all.
constexpr std::size_t most_corners = 10'000;
constexpr double most_steps = 1e9;

void check(const Polygons& polygons, const std::filesystem::path& file) {
    const auto n = polygons.points.size();
    for (std::size_t v = 0; v < n; ++v)
        if (!(polygons.points[v].array().abs() < beyond_all_units).all())
            throw InvalidInput(fmt::format(
                "{}, vertex {}: ({}, {}, {}) is not finite, or beyond 1e30. Export the surface again without that "
                "vertex.",
                file.string(), v + static_cast<std::size_t>(polygons.first_index), polygons.points[v].x(),
                polygons.points[v].y(), polygons.points[v].z()));
    if (polygons.begins.empty())
        throw InvalidInput(n == 0
                               ? fmt::format("{}: holds no vertices and no faces. Export a surface of triangles or "
                                             "polygons.",
                                             file.string())
                               : fmt::format("{}: holds {} vertices but no faces, it is a point cloud. Mesh the points "
                                             "first (for instance Poisson reconstruction in MeshLab).",
                                             file.string(), n));
    double steps = 0;
    for (std::size_t i = 0; i < polygons.begins.size(); ++i) {
        const auto corners = polygons.polygon(i);
        if (corners.size() > 4) steps += std::pow(static_cast<double>(corners.size()), 2);
        if (corners.size() > most_corners || steps > most_steps)
            throw InvalidInput(fmt::format(
                "{}: a face with {} corners{}; up to {} are allowed. Cut the faces into triangles where the surface "
                "was made (Triangulate in Blender or MeshLab), and export it again.",
                where(polygons, i, file), corners.size(), corners.size() > most_corners ? "" : " behind many like it",
                most_corners));
        if (corners.size() < 2)
            throw InvalidInput(fmt::format("{}: a face with {} corner(s); three or more are allowed. Remove it.",
                                           where(polygons, i, file), corners.size()));
        for (const int v : corners)
            if (v < 0 || static_cast<std::size_t>(v) >= n)
                throw InvalidInput(
                    fmt::format("{}: vertex {} does not exist; {} to {} are allowed. Mend the face, or export "
                                "the surface again.",
                                where(polygons, i, file), v + polygons.first_index, polygons.first_index,
                                static_cast<long>(n) - 1 + polygons.first_index));
    }
}

}  // namespace

void Polygons::begin_polygon(int line) {
    begins.push_back(corners.size());
    if (line > 0) lines.push_back(line);
}

std::span<const int> Polygons::polygon(std::size_t i) const {
    const std::size_t end = i + 1 < begins.size() ? begins[i + 1] : corners.size();
    return std::span(corners).subspan(begins[i], end - begins[i]);
}

Surface triangulate(const Polygons& polygons, const std::filesystem::path& file) {
    check(polygons, file);
    std::vector<int> triangles;
    triangles.reserve(polygons.corners.size());
    for (std::size_t i = 0; i < polygons.begins.size(); ++i) {
        const auto corners = polygons.polygon(i);
        // A face of two corners is a triangle without area: checks count it, repair drops it.
        if (corners.size() <= 3) {
            triangles.insert(triangles.end(), {corners[0], corners[1], corners.back()});
            continue;
        }
        std::vector<Vec3> positions;
        positions.reserve(corners.size());
        for (const int v : corners) positions.push_back(polygons.points[static_cast<std::size_t>(v)]);
        for (const int corner : cut_ears(positions)) triangles.push_back(corners[static_cast<std::size_t>(corner)]);
    }
    Surface surface;
    surface.vertices.resize(static_cast<Eigen::Index>(polygons.points.size()), 3);
    for (std::size_t v = 0; v < polygons.points.size(); ++v)
        surface.vertices.row(static_cast<Eigen::Index>(v)) = polygons.points[v];
    surface.triangles =
        Eigen::Map<const Triangles>(triangles.data(), static_cast<Eigen::Index>(triangles.size() / 3), 3);
    return surface;
}

}  // namespace palpate::mesh
