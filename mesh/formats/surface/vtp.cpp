#include <vtkCellType.h>

#include <algorithm>
#include <array>

#include "mesh/formats/surface/surface_formats.h"
#include "mesh/formats/vtk/vtk_polygons.h"

namespace palpate::mesh {
namespace {

/// `most` corners, midsides behind them left out.
void add_polygon(std::span<const std::int64_t> cell, std::size_t most, Polygons& polygons) {
    polygons.begin_polygon();
    for (const std::int64_t corner : cell.first(std::min(most, cell.size())))
        polygons.corners.push_back(static_cast<int>(corner));
}

/// A strip is a row of triangles of which every other one is turned.
void add_strip(std::span<const std::int64_t> cell, Polygons& polygons) {
    for (std::size_t i = 0; i + 2 < cell.size(); ++i) {
        polygons.begin_polygon();
        for (const std::size_t j : {i, i + 1 + i % 2, i + 2 - i % 2})
            polygons.corners.push_back(static_cast<int>(cell[j]));
    }
}

void add_pixel(std::span<const std::int64_t> cell, Polygons& polygons) {
    if (cell.size() < 4) return add_polygon(cell, cell.size(), polygons);
    const std::array round{cell[0], cell[1], cell[3], cell[2]};
    add_polygon(round, round.size(), polygons);
}

}  // namespace

Polygons polygons_of(const VtkData& data) {
    Polygons polygons;
    for (const auto& point : data.points.rowwise()) polygons.points.emplace_back(point);
    for (std::size_t c = 0; c < data.types.size(); ++c) {
        const auto cell = data.cell(c);
        switch (data.types[c]) {
            case VTK_POLYGON:
                add_polygon(cell, cell.size(), polygons);
                break;
            case VTK_TRIANGLE:
            case VTK_QUADRATIC_TRIANGLE:
            case VTK_BIQUADRATIC_TRIANGLE:
                add_polygon(cell, 3, polygons);
                break;
            case VTK_QUAD:
            case VTK_QUADRATIC_QUAD:
            case VTK_BIQUADRATIC_QUAD:
                add_polygon(cell, 4, polygons);
                break;
            case VTK_PIXEL:
                add_pixel(cell, polygons);
                break;
            case VTK_TRIANGLE_STRIP:
                add_strip(cell, polygons);
                break;
            default:  // points and lines
                break;
        }
    }
    return polygons;
}

Polygons read_vtp(const std::string&, const std::filesystem::path& file) {
    return polygons_of(read_vtk(file, VtkKind::poly_data));
}

}  // namespace palpate::mesh
