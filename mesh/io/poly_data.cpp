#include "mesh/io/poly_data.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <regex>

#include "mesh/errors.h"
#include "mesh/io/atomic_file.h"
#include "mesh/io/vtk_errors.h"
#include "mesh/io/vtk_grid.h"

namespace palpate::mesh {
namespace {

/// The cells with so many corners, a row each.
template <int corners>
Eigen::Matrix<int, Eigen::Dynamic, corners> cells_of(vtkCellArray* cells) {
    std::vector<int> rows;
    vtkIdType size = 0;
    const vtkIdType* points = nullptr;
    for (cells->InitTraversal(); cells->GetNextCell(size, points);) {
        if (size == corners) rows.insert(rows.end(), points, points + corners);
    }
    Eigen::Matrix<int, Eigen::Dynamic, corners> result(static_cast<Eigen::Index>(rows.size()) / corners, corners);
    for (Eigen::Index i = 0; i < result.size(); ++i) result(i / corners, i % corners) = rows[i];
    return result;
}

}  // namespace

PolyData read_poly_data(const std::filesystem::path& file) {
    if (!std::filesystem::is_regular_file(file)) throw IoError(fmt::format("{}: no such file", file.string()));
    vtkNew<vtkXMLPolyDataReader> reader;
    const VtkErrors errors;
    reader->SetFileName(file.c_str());
    reader->Update();
    if (errors.heard() || reader->GetErrorCode() != 0) {
        throw InvalidInput(
            fmt::format("{}: this is no whole VTP file (VTK XML poly data); write it again", file.string()));
    }
    vtkPolyData* poly = reader->GetOutput();
    PolyData result;
    result.points.resize(poly->GetNumberOfPoints(), 3);
    for (Eigen::Index i = 0; i < result.points.rows(); ++i) poly->GetPoint(i, result.points.row(i).data());
    result.triangles = cells_of<3>(poly->GetPolys());
    result.lines = cells_of<2>(poly->GetLines());
    result.data = {arrays_of(poly->GetPointData()), arrays_of(poly->GetCellData())};
    return result;
}

std::vector<SeriesStep> read_pvd(const std::filesystem::path& file) {
    static const std::regex entry(R"re(timestep="([^"]*)"[^>]*file="([^"]*)")re");
    const std::string text = read_text(file);
    std::vector<SeriesStep> steps;
    for (auto it = std::sregex_iterator(text.begin(), text.end(), entry); it != std::sregex_iterator(); ++it) {
        steps.push_back({std::strtod((*it)[1].str().c_str(), nullptr), file.parent_path() / (*it)[2].str()});
    }
    return steps;
}

}  // namespace palpate::mesh
