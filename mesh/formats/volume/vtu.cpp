#include <fmt/format.h>
#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "mesh/errors.h"
#include "mesh/formats/volume/elements.h"
#include "mesh/formats/vtk/vtk_data.h"

namespace palpate::mesh {
namespace {

/// Names under which mesh generators write which material a cell is of.
constexpr std::array material_names{"material",         "materialid", "materialids", "material_id",  "gmsh:physical",
                                    "gmsh:geometrical", "medit:ref",  "tetgen:ref",  "region",       "regions",
                                    "regionid",         "label",      "labels",      "cellentityids"};

bool are_whole_numbers(const Eigen::MatrixXd& values) {
    constexpr double most = 9e15;  // whole numbers that a double tells apart
    return values.unaryExpr([](double v) { return std::abs(v) <= most && v == std::floor(v); }).all();
}

const DataArray* material_of(const VtkData& grid) {
    for (const char* wanted : material_names)
        for (const DataArray& array : grid.of_cells) {
            if (array.values.cols() != 1 || !are_whole_numbers(array.values)) continue;
            std::string name = array.name;
            std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
            if (name == wanted) return &array;
        }
    return nullptr;
}

}  // namespace

Elements read_vtu_elements(const std::filesystem::path& file) {
    const VtkData grid = read_vtk(file, VtkKind::unstructured_grid);
    Elements elements;
    for (Eigen::Index i = 0; i < grid.points.rows(); ++i) {
        elements.node_numbers.push_back(i);
        elements.nodes.emplace_back(grid.points.row(i));
    }
    const DataArray* materials = material_of(grid);
    for (std::size_t e = 0; e < grid.types.size(); ++e) {
        const int type = grid.types[e];
        if (is_flat(type)) continue;
        const auto nodes = grid.cell(e);
        const bool is_tetrahedron =
            (type == VTK_TETRA && nodes.size() == 4) || (type == VTK_QUADRATIC_TETRA && nodes.size() == 10);
        if (!is_tetrahedron)
            throw InvalidInput(fmt::format(
                "{}: cell {} is of VTK type {} with {} nodes; tetrahedra of type {} (4 nodes) or {} (10) are "
                "allowed.",
                file.string(), e, type, nodes.size(), int{VTK_TETRA}, int{VTK_QUADRATIC_TETRA}));
        elements.add(static_cast<std::int64_t>(e), {nodes.begin(), nodes.end()}, file.string());
        if (materials)
            elements.materials.push_back(static_cast<std::int64_t>(materials->values(static_cast<Eigen::Index>(e), 0)));
    }
    return elements;
}

}  // namespace palpate::mesh
