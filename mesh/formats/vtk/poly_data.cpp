#include "mesh/formats/vtk/poly_data.h"

#include <vtkCellType.h>

#include <regex>

#include "mesh/text/atomic_file.h"

namespace palpate::mesh {
namespace {

/// The cells of a type with so many corners, a row each.
template <int corners>
Eigen::Matrix<int, Eigen::Dynamic, corners> cells_of(const VtkData& data, int type) {
    std::vector<int> rows;
    for (std::size_t c = 0; c < data.types.size(); ++c) {
        const auto cell = data.cell(c);
        if (data.types[c] != type || cell.size() != corners) continue;
        for (const std::int64_t corner : cell) rows.push_back(static_cast<int>(corner));
    }
    Eigen::Matrix<int, Eigen::Dynamic, corners> result(static_cast<Eigen::Index>(rows.size()) / corners, corners);
    for (Eigen::Index i = 0; i < result.size(); ++i) result(i / corners, i % corners) = rows[i];
    return result;
}

}  // namespace

PolyData as_poly_data(VtkData data) {
    PolyData result;
    result.triangles = cells_of<3>(data, VTK_POLYGON);
    result.lines = cells_of<2>(data, VTK_POLY_LINE);
    result.points = std::move(data.points);
    result.data = {std::move(data.of_points), std::move(data.of_cells)};
    return result;
}

PolyData read_poly_data(const std::filesystem::path& file) {
    return as_poly_data(read_own_vtk(file, VtkKind::poly_data));
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
