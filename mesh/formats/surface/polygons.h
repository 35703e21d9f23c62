#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// What a surface file holds, before its polygons are cut into triangles.
struct Polygons {
    std::vector<Vec3> points;
    std::vector<int> corners;         // of all polygons, one after the other
    std::vector<std::size_t> begins;  // where each polygon begins in `corners`
    std::vector<int> lines;           // of the file behind each polygon; empty: binary
    int first_index = 0;              // of the first vertex, as the file counts

    void begin_polygon(int line = 0);
    std::span<const int> polygon(std::size_t i) const;
};

/// Cuts every polygon into triangles.
/// @throws InvalidInput naming line or element: no faces, fewer than three corners, an index out of range, a coordinate
/// that is not finite.
Surface triangulate(const Polygons& polygons, const std::filesystem::path& file);

/// Ear clipping in the polygon's best plane: right for concave polygons too; three corner numbers a triangle.
std::vector<int> cut_ears(const std::vector<Vec3>& corners);

}  // namespace palpate::mesh
