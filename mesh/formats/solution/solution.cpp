#include "mesh/formats/solution/solution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "mesh/errors.h"
#include "mesh/formats/solution/solution_parts.h"

namespace palpate::mesh {
namespace {

std::string extension_of(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
    return extension;
}

}  // namespace

void set_mesh(Solution& solution, const Cells& cells) {
    solution.nodes.resize(static_cast<Eigen::Index>(cells.nodes.size()), 3);
    for (std::size_t i = 0; i < cells.nodes.size(); ++i)
        solution.nodes.row(static_cast<Eigen::Index>(i)) = cells.nodes[i];
    solution.body =
        assemble(as_tetrahedra(cells, solution.notes), solution.file, solution.notes, &solution.node_of_body);
    Eigen::VectorXi node;
    solution.surface = boundary_surface(solution.body, &node);
    for (const int n : node) solution.node_of_vertex.push_back(solution.node_of_body[static_cast<std::size_t>(n)]);
}

Solution mesh_of(const Deck& deck) {
    Solution solution;
    solution.file = deck.file;
    set_mesh(solution, deck.cells);
    return solution;
}

NodeRows::NodeRows(const std::vector<std::int64_t>& numbers, const std::filesystem::path& file) {
    for (std::size_t i = 0; i < numbers.size(); ++i)
        if (!rows_.try_emplace(numbers[i], static_cast<Eigen::Index>(i)).second)
            throw InvalidInput(
                fmt::format("{}: node {} stands there twice. Export the mesh again.", file.string(), numbers[i]));
}

Eigen::Index NodeRows::row(std::int64_t number, const std::string& where) const {
    const auto found = rows_.find(number);
    if (found == rows_.end())
        throw InvalidInput(fmt::format("{}: a displacement of node {}, which the mesh does not hold.", where, number));
    return found->second;
}

bool is_solution_file(const std::filesystem::path& file) {
    const std::string extension = extension_of(file);
    return extension == ".frd" || extension == ".dat" || extension == ".vtu" || extension == ".vtp";
}

Solution read_solution(const std::filesystem::path& file, const Deck* deck, const std::string& array) {
    const std::string extension = extension_of(file);
    Solution solution = extension == ".frd"   ? read_frd(file)
                        : extension == ".dat" ? read_dat(file, deck)
                                              : read_vtk_solution(file, array);
    if (solution.steps.empty())
        throw InvalidInput(
            fmt::format("{}: holds no displacements. Let the solver write them (CalculiX: *NODE FILE or "
                        "*NODE PRINT, and U behind it).",
                        file.string()));
    return solution;
}

}  // namespace palpate::mesh
