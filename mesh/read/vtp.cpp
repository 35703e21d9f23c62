#include <vtkCellType.h>

#include "mesh/io/vtk_data.h"
#include "mesh/read/polygons.h"

namespace palpate::mesh {
namespace {

void add_polygon(std::span<const std::int64_t> cell, Polygons& polygons) {
    polygons.begin_polygon();
    for (const std::int64_t corner : cell) polygons.corners.push_back(static_cast<int>(corner));
}

/// A strip is a row of triangles of which every other one is turned.
void add_strip(std::span<const std::int64_t> cell, Polygons& polygons) {
    for (std::size_t i = 0; i + 2 < cell.size(); ++i) {
        polygons.begin_polygon();
        for (const std::size_t j : {i, i + 1 + i % 2, i + 2 - i % 2})
            polygons.corners.push_back(static_cast<int>(cell[j]));
    }
}

}  // namespace

Polygons read_vtp(const std::string&, const std::filesystem::path& file) {
    const VtkData data = read_vtk(file, VtkKind::poly_data);
    Polygons polygons;
    for (const auto& point : data.points.rowwise()) polygons.points.emplace_back(point);
    for (std::size_t c = 0; c < data.types.size(); ++c) {
        if (data.types[c] == VTK_POLYGON) add_polygon(data.cell(c), polygons);
        if (data.types[c] == VTK_TRIANGLE_STRIP) add_strip(data.cell(c), polygons);
    }
    return polygons;
}

}  // namespace palpate::mesh
