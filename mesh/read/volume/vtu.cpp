#include <fmt/format.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkGenericCell.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "mesh/errors.h"
#include "mesh/io/vtk_grid.h"
#include "mesh/read/volume/elements.h"

namespace palpate::mesh {
namespace {

/// Names under which mesh generators write which material a cell is of.
constexpr std::array material_names{"material",         "materialid", "materialids", "material_id",  "gmsh:physical",
                                    "gmsh:geometrical", "medit:ref",  "tetgen:ref",  "region",       "regions",
                                    "regionid",         "label",      "labels",      "cellentityids"};

vtkDataArray* material_of(vtkUnstructuredGrid* grid) {
    vtkCellData* data = grid->GetCellData();
    for (const char* wanted : material_names)
        for (int a = 0; a < data->GetNumberOfArrays(); ++a) {
            vtkDataArray* array = data->GetArray(a);
            if (!array || !array->GetName() || array->GetNumberOfComponents() != 1) continue;
            std::string name = array->GetName();
            std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
            if (name == wanted) return array;
        }
    return nullptr;
}

}  // namespace

Elements read_vtu_elements(const std::filesystem::path& file) {
    const vtkSmartPointer<vtkUnstructuredGrid> grid = read_grid(file);
    Elements elements;
    const Points points = points_of(file, grid);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        elements.node_numbers.push_back(i);
        elements.nodes.emplace_back(points.row(i));
    }
    vtkDataArray* materials = material_of(grid);
    vtkNew<vtkGenericCell> kind;
    for (vtkIdType e = 0; e < grid->GetNumberOfCells(); ++e) {
        const int type = grid->GetCellType(e);
        kind->SetCellType(type);
        if (kind->GetCellDimension() < 3) continue;
        vtkIdType count = 0;
        const vtkIdType* nodes = nullptr;
        grid->GetCellPoints(e, count, nodes);
        const bool is_tetrahedron = (type == VTK_TETRA && count == 4) || (type == VTK_QUADRATIC_TETRA && count == 10);
        if (!is_tetrahedron)
            throw InvalidInput(fmt::format(
                "{}: cell {} is of VTK type {} with {} nodes; tetrahedra of type {} (4 nodes) or {} (10) are "
                "allowed.",
                file.string(), e, type, count, int{VTK_TETRA}, int{VTK_QUADRATIC_TETRA}));
        elements.add(e, {nodes, nodes + count}, file.string());
        if (materials) elements.materials.push_back(static_cast<std::int64_t>(materials->GetTuple1(e)));
    }
    return elements;
}

}  // namespace palpate::mesh
