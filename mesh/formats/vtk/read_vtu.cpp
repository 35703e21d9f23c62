#include <fmt/format.h>
#include <vtkCellType.h>

#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_data.h"

namespace palpate::mesh {
namespace {

Tetrahedra read_tetrahedra(const std::filesystem::path& file, const VtkData& grid) {
    if (grid.types.empty())
        throw InvalidInput(fmt::format("{}: holds no cells. Tetrahedra are needed.", file.string()));
    const int type = grid.types.front();
    if (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA)
        throw InvalidInput(fmt::format("{}: cell 0 is of VTK type {}. Tetrahedra are needed: {} (4 nodes) or {} (10).",
                                       file.string(), type, int{VTK_TETRA}, int{VTK_QUADRATIC_TETRA}));
    Tetrahedra tetrahedra(static_cast<Eigen::Index>(grid.types.size()), type == VTK_TETRA ? 4 : 10);
    for (std::size_t e = 0; e < grid.types.size(); ++e) {
        if (grid.types[e] != type)
            throw InvalidInput(
                fmt::format("{}: cell {} is of VTK type {}, cell 0 of type {}. Keep tetrahedra of one kind.",
                            file.string(), e, grid.types[e], type));
        const auto nodes = grid.cell(e);
        if (std::ssize(nodes) != tetrahedra.cols())
            throw InvalidInput(fmt::format("{}: cell {} has {} nodes instead of {}.", file.string(), e, nodes.size(),
                                           tetrahedra.cols()));
        for (std::size_t c = 0; c < nodes.size(); ++c)
            tetrahedra(static_cast<Eigen::Index>(e), static_cast<Eigen::Index>(c)) = static_cast<int>(nodes[c]);
    }
    return tetrahedra;
}

}  // namespace

VolumeMesh read_vtu(const std::filesystem::path& file, MeshData* data) {
    VtkData grid = read_vtk(file, VtkKind::unstructured_grid);
    VolumeMesh mesh;
    mesh.nodes = std::move(grid.points);
    mesh.tetrahedra = read_tetrahedra(file, grid);
    const Eigen::VectorXd volumes = element_volumes(mesh);
    Eigen::Index worst = 0;
    if (!(volumes.minCoeff(&worst) > 0))
        throw InvalidInput(
            fmt::format("{}: element {} has a volume of {:g} mm^3, it is flat or inside out. Number its "
                        "corners as VTK does: 0, 1, 2 counter-clockwise seen from 3.",
                        file.string(), worst, volumes[worst]));
    mesh.faces = boundary_faces(mesh.tetrahedra);
    if (data) *data = {std::move(grid.of_points), std::move(grid.of_cells)};
    return mesh;
}

}  // namespace palpate::mesh
