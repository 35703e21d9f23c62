#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <fstream>

#include "mesh/errors.h"
#include "mesh/io/read_vtk.h"
#include "mesh/io/vtk_errors.h"
#include "mesh/io/vtk_files.h"
#include "mesh/io/vtk_grid.h"
#include "mesh/io/words.h"

namespace palpate::mesh {

vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::filesystem::path& file) {
    if (!std::filesystem::is_regular_file(file)) throw IoError(fmt::format("{}: no such file.", file.string()));
    if (!std::ifstream(file)) throw IoError(fmt::format("{}: cannot be opened for reading.", file.string()));
    const VtkErrors errors;
    vtkNew<vtkXMLUnstructuredGridReader> reader;
    reader->SetFileName(file.c_str());
    read_vtk(file, [&] { reader->Update(); });
    if (errors.heard() || reader->GetErrorCode() != 0)
        throw InvalidInput(
            fmt::format("{}: this is no whole VTU file (VTK XML unstructured grid). Write it again, or convert it.",
                        file.string()));
    return reader->GetOutput();
}

Points points_of(const std::filesystem::path& file, vtkUnstructuredGrid* grid) {
    Points points(grid->GetNumberOfPoints(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        grid->GetPoint(i, points.row(i).data());
        if (!(points.row(i).array().abs() < beyond_all_units).all())
            throw InvalidInput(
                fmt::format("{}: point {} has a coordinate that is not finite, or beyond 1e30.", file.string(), i));
    }
    return points;
}

std::vector<DataArray> arrays_of(vtkFieldData* source) {
    std::vector<DataArray> arrays;
    for (int a = 0; a < source->GetNumberOfArrays(); ++a) {
        vtkDataArray* values = source->GetArray(a);  // none for an array of texts
        if (!values || !values->GetName()) continue;
        DataArray& array = arrays.emplace_back();
        array.name = values->GetName();
        array.values.resize(values->GetNumberOfTuples(), values->GetNumberOfComponents());
        for (Eigen::Index i = 0; i < array.values.rows(); ++i)
            for (Eigen::Index c = 0; c < array.values.cols(); ++c)
                array.values(i, c) = values->GetComponent(i, static_cast<int>(c));
    }
    return arrays;
}

namespace {

Tetrahedra read_tetrahedra(const std::filesystem::path& file, vtkUnstructuredGrid* grid) {
    const vtkIdType cells = grid->GetNumberOfCells();
    if (cells == 0) throw InvalidInput(fmt::format("{}: holds no cells. Tetrahedra are needed.", file.string()));
    const int type = grid->GetCellType(0);
    if (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA)
        throw InvalidInput(fmt::format("{}: cell 0 is of VTK type {}. Tetrahedra are needed: {} (4 nodes) or {} (10).",
                                       file.string(), type, int{VTK_TETRA}, int{VTK_QUADRATIC_TETRA}));
    Tetrahedra tetrahedra(cells, type == VTK_TETRA ? 4 : 10);
    for (vtkIdType e = 0; e < cells; ++e) {
        if (grid->GetCellType(e) != type)
            throw InvalidInput(
                fmt::format("{}: cell {} is of VTK type {}, cell 0 of type {}. Keep tetrahedra of one kind.",
                            file.string(), e, grid->GetCellType(e), type));
        vtkIdType count = 0;
        const vtkIdType* nodes = nullptr;
        grid->GetCellPoints(e, count, nodes);
        if (count != tetrahedra.cols())
            throw InvalidInput(
                fmt::format("{}: cell {} has {} nodes instead of {}.", file.string(), e, count, tetrahedra.cols()));
        for (vtkIdType c = 0; c < count; ++c) {
            if (nodes[c] < 0 || nodes[c] >= grid->GetNumberOfPoints())
                throw InvalidInput(fmt::format("{}: cell {} names point {}, but there are {}.", file.string(), e,
                                               nodes[c], grid->GetNumberOfPoints()));
            tetrahedra(e, c) = static_cast<int>(nodes[c]);
        }
    }
    return tetrahedra;
}

}  // namespace

VolumeMesh read_vtu(const std::filesystem::path& file, MeshData* data) {
    const vtkSmartPointer<vtkUnstructuredGrid> grid = read_grid(file);
    VolumeMesh mesh;
    mesh.nodes = points_of(file, grid);
    mesh.tetrahedra = read_tetrahedra(file, grid);
    const Eigen::VectorXd volumes = element_volumes(mesh);
    Eigen::Index worst = 0;
    if (!(volumes.minCoeff(&worst) > 0))
        throw InvalidInput(
            fmt::format("{}: element {} has a volume of {:g} mm^3, it is flat or inside out. Number its "
                        "corners as VTK does: 0, 1, 2 counter-clockwise seen from 3.",
                        file.string(), worst, volumes[worst]));
    mesh.faces = boundary_faces(mesh.tetrahedra);
    if (data) *data = {arrays_of(grid->GetPointData()), arrays_of(grid->GetCellData())};
    return mesh;
}

}  // namespace palpate::mesh
