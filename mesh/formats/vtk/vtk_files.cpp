#include "mesh/formats/vtk/vtk_files.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cassert>

#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_errors.h"
#include "mesh/text/atomic_file.h"

namespace palpate::mesh {

namespace {

vtkNew<vtkPoints> to_vtk(const Points& points) {
    vtkNew<vtkPoints> result;
    result->SetDataTypeToDouble();
    result->SetNumberOfPoints(points.rows());
    for (Eigen::Index i = 0; i < points.rows(); ++i) result->SetPoint(i, points(i, 0), points(i, 1), points(i, 2));
    return result;
}

/// A cell per row of point indices.
template <class Rows>
vtkNew<vtkCellArray> cells_to_vtk(const Rows& rows) {
    vtkNew<vtkCellArray> cells;
    cells->AllocateExact(rows.rows(), rows.size());
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
        cells->InsertNextCell(static_cast<int>(rows.cols()));
        for (Eigen::Index c = 0; c < rows.cols(); ++c) cells->InsertCellPoint(rows(i, c));
    }
    return cells;
}

void add_arrays(vtkFieldData* target, const std::vector<DataArray>& arrays, [[maybe_unused]] vtkIdType rows) {
    for (const DataArray& array : arrays) {
        assert(array.values.rows() == rows);
        vtkNew<vtkDoubleArray> values;
        values->SetName(array.name.c_str());
        values->SetNumberOfComponents(static_cast<int>(array.values.cols()));
        values->SetNumberOfTuples(array.values.rows());
        for (Eigen::Index i = 0; i < array.values.rows(); ++i)
            for (Eigen::Index c = 0; c < array.values.cols(); ++c)
                values->SetTypedComponent(i, static_cast<int>(c), array.values(i, c));
        target->AddArray(values);
    }
}

void add_data(vtkDataSet* target, const MeshData& data) {
    add_arrays(target->GetPointData(), data.points, target->GetNumberOfPoints());
    add_arrays(target->GetCellData(), data.cells, target->GetNumberOfCells());
}

/// By which the program knows its own files: those may be replaced.
constexpr const char* signature = "<!-- made by palpate -->\n";

template <class Writer>
void write(const std::filesystem::path& file, vtkDataSet* data) {
    vtkNew<Writer> writer;
    const VtkErrors errors;
    writer->WriteToOutputStringOn();
    writer->SetInputData(data);
    // Inline: an up-to-date Debian 12's ParaView finds no appended data, as its Expat defers parsing.
    writer->SetDataModeToBinary();
    writer->SetCompressorTypeToZLib();
    if (writer->Write() == 0 || errors.heard() || writer->GetErrorCode() != 0) {
        throw IoError(fmt::format(
            "{}: VTK cannot encode it. Is there too little memory? Longer edges make a smaller mesh", file.string()));
    }
    std::string text = writer->GetOutputString();
    text.insert(text.find('\n') + 1, signature);
    write_text(file, text);
}

std::string xml_escaped(const std::string& text) {
    std::string result;
    for (const char c : text) switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    return result;
}

}  // namespace

void write_vtu(const std::filesystem::path& file, const VolumeMesh& mesh, const MeshData& data) {
    vtkNew<vtkUnstructuredGrid> grid;
    grid->SetPoints(to_vtk(mesh.nodes));
    grid->SetCells(mesh.is_quadratic() ? VTK_QUADRATIC_TETRA : VTK_TETRA, cells_to_vtk(mesh.tetrahedra));
    add_data(grid, data);
    write<vtkXMLUnstructuredGridWriter>(file, grid);
}

void write_vtp(const std::filesystem::path& file, const Surface& surface, const MeshData& data) {
    vtkNew<vtkPolyData> poly;
    poly->SetPoints(to_vtk(surface.vertices));
    poly->SetPolys(cells_to_vtk(surface.triangles));
    add_data(poly, data);
    write<vtkXMLPolyDataWriter>(file, poly);
}

void write_vtp_lines(const std::filesystem::path& file, const Points& points,
                     const Eigen::Matrix<int, Eigen::Dynamic, 2>& lines, const MeshData& data) {
    vtkNew<vtkPolyData> poly;
    poly->SetPoints(to_vtk(points));
    // Without lines the points are the cells, else nothing would be drawn.
    if (lines.rows() > 0)
        poly->SetLines(cells_to_vtk(lines));
    else
        poly->SetVerts(cells_to_vtk(Eigen::VectorXi::LinSpaced(points.rows(), 0, static_cast<int>(points.rows()) - 1)));
    add_data(poly, data);
    write<vtkXMLPolyDataWriter>(file, poly);
}

void write_pvd(const std::filesystem::path& file, const std::vector<SeriesStep>& steps) {
    std::string text = fmt::format("<?xml version=\"1.0\"?>\n{}", signature) +
                       "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
                       "  <Collection>\n";
    for (const SeriesStep& step : steps) {
        const auto relative =
            std::filesystem::absolute(step.file).lexically_proximate(std::filesystem::absolute(file).parent_path());
        text += fmt::format("    <DataSet timestep=\"{}\" file=\"{}\"/>\n", step.time,
                            xml_escaped(relative.generic_string()));
    }
    write_text(file, text + "  </Collection>\n</VTKFile>\n");
}

}  // namespace palpate::mesh
