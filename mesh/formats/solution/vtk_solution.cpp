#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <numeric>

#include "mesh/errors.h"
#include "mesh/formats/solution/solution_parts.h"
#include "mesh/formats/solution/vtk_cells.h"
#include "mesh/formats/vtk/poly_data.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

/// What programs call displacements, in small letters.
constexpr std::array names_of_displacement{"displacement", "displacement [mm]",  "displacements", "disp", "displ", "u",
                                           "deformation",  "displacement_vector"};

std::string in_small_letters(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

/// Of arrays of points the one that is the displacement.
const Eigen::MatrixXd& displacement_of(const std::vector<DataArray>& arrays, const std::filesystem::path& file,
                                       const std::string& wanted) {
    std::vector<const DataArray*> vectors;
    std::vector<std::string> names;
    for (const DataArray& array : arrays) {
        if (array.values.cols() != 3) continue;
        vectors.push_back(&array);
        names.push_back(array.name);
    }
    if (!wanted.empty()) {
        const auto found = std::ranges::find(names, wanted);
        if (found == names.end())
            throw InvalidInput(fmt::format("{}: no point array {} of three components; there are {}.", file.string(),
                                           cited(wanted), names.empty() ? "none" : listed(names)));
        return vectors[static_cast<std::size_t>(found - names.begin())]->values;
    }
    for (const char* known : names_of_displacement)
        for (std::size_t a = 0; a < names.size(); ++a)
            if (in_small_letters(names[a]) == known) return vectors[a]->values;
    if (vectors.size() == 1) return vectors.front()->values;
    throw InvalidInput(
        fmt::format("{}: which of its point arrays of three components is the displacement? There are "
                    "{}; name it with --array.",
                    file.string(), names.empty() ? "none" : listed(names)));
}

/// Under the name that ParaView gives to the time of a file.
double time_in(const std::vector<DataArray>& of_file) {
    const auto found = std::ranges::find(of_file, "TimeValue", &DataArray::name);
    return found == of_file.end() || found->values.size() == 0 ? 0 : found->values(0, 0);
}

Points checked(const Eigen::MatrixXd& displacement, const std::filesystem::path& file) {
    for (Eigen::Index i = 0; i < displacement.rows(); ++i)
        if (!(displacement.row(i).array().abs() < beyond_all_units).all())
            throw InvalidInput(
                fmt::format("{}: the displacement of point {} is not finite, or beyond 1e30.", file.string(), i));
    return displacement;
}

}  // namespace

Solution read_vtk_solution(const std::filesystem::path& file, const std::string& array) {
    Solution solution;
    solution.file = file;
    if (in_small_letters(file.extension().string()) == ".vtu") {
        const VtkData grid = read_vtk(file, VtkKind::unstructured_grid);
        set_mesh(solution, cells_of(grid, file));
        solution.steps.push_back({time_in(grid.of_file), checked(displacement_of(grid.of_points, file, array), file)});
        return solution;
    }
    const PolyData data = as_poly_data(read_vtk(file, VtkKind::poly_data));
    if (data.triangles.rows() == 0)
        throw InvalidInput(fmt::format("{}: holds no triangles; a surface of triangles is needed.", file.string()));
    solution.nodes = data.points;
    solution.surface = {data.points, data.triangles};
    solution.node_of_vertex.resize(static_cast<std::size_t>(solution.nodes.rows()));
    std::iota(solution.node_of_vertex.begin(), solution.node_of_vertex.end(), 0);
    solution.steps.push_back({0, checked(displacement_of(data.data.points, file, array), file)});
    return solution;
}

}  // namespace palpate::mesh
