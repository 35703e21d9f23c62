#include "mesh/formats/solution/solution.h"

namespace palpate::mesh {

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

}  // namespace palpate::mesh
