#include "mesh/formats/solution/vtk_cells.h"

#include <fmt/format.h>
#include <vtkCellType.h>

#include "mesh/errors.h"

namespace palpate::mesh {
namespace {

CellShape shape_of(int type, std::size_t cell, const std::filesystem::path& file) {
    switch (type) {
        case VTK_TETRA:
        case VTK_QUADRATIC_TETRA:
            return CellShape::tetrahedron;
        case VTK_PYRAMID:
        case VTK_QUADRATIC_PYRAMID:
            return CellShape::pyramid;
        case VTK_WEDGE:
        case VTK_QUADRATIC_WEDGE:
            return CellShape::wedge;
        case VTK_HEXAHEDRON:
        case VTK_QUADRATIC_HEXAHEDRON:
        case VTK_TRIQUADRATIC_HEXAHEDRON:
            return CellShape::hexahedron;
        default:
            throw InvalidInput(
                fmt::format("{}: cell {} is of VTK type {}; tetrahedra, hexahedra, wedges and pyramids "
                            "are allowed, and cells without volume are skipped.",
                            file.string(), cell, type));
    }
}

}  // namespace

Cells cells_of(const VtkData& grid, const std::filesystem::path& file) {
    Cells cells;
    for (Eigen::Index i = 0; i < grid.points.rows(); ++i) {
        cells.node_numbers.push_back(i);
        cells.nodes.emplace_back(grid.points.row(i));
    }
    for (std::size_t e = 0; e < grid.types.size(); ++e) {
        if (is_flat(grid.types[e])) continue;
        const auto nodes = grid.cell(e);
        const CellShape shape = shape_of(grid.types[e], e, file);
        if (std::ssize(nodes) < nodes_of(shape).corners)
            throw InvalidInput(fmt::format("{}: cell {} has {} nodes, too few.", file.string(), e, nodes.size()));
        cells.cells.push_back({static_cast<std::int64_t>(e), shape, {nodes.begin(), nodes.end()}});
    }
    return cells;
}

}  // namespace palpate::mesh
