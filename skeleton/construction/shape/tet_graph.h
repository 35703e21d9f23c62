#pragma once

#include <array>
#include <utility>
#include <vector>

#include "mesh/core/volume_mesh.h"

namespace palpate::skeleton {

/// A body cut into small tetrahedra, and which of them touch: what spheres share out between them.
struct TetGraph {
    using Quads = Eigen::Matrix<int, Eigen::Dynamic, 4, Eigen::RowMajor>;

    Points nodes;             // (n x 3) [mm]
    Quads corners;            // (m x 4), positive volume
    Quads neighbors;          // across the face opposite to each corner (m x 4); -1: the outside
    Points centers;           // (m x 3) [mm]
    Eigen::VectorXd volumes;  // (m) [mm^3]

    int size() const { return static_cast<int>(corners.rows()); }
    Vec3 node(int tet, int corner) const { return nodes.row(corners(tet, corner)); }
    /// Area vector of the face opposite to a corner, outward [mm^2].
    Vec3 face_area(int tet, int corner) const;
    /// The three corners of that face, counter-clockwise seen from outside.
    std::array<int, 3> face_nodes(int tet, int corner) const;
};

/// Walks over neighbours from the first tetrahedron, calls visit(tet, corner) of each face that leads to a new one, and
/// tells which were reached (m).
template <typename Visit>
std::vector<char> walk(const TetGraph& graph, const Visit& visit) {
    std::vector<char> seen(graph.size());
    std::vector<int> front{0};
    seen[0] = 1;
    for (std::size_t i = 0; i < front.size(); ++i) {
        for (int corner = 0; corner < 4; ++corner) {
            const int next = graph.neighbors(front[i], corner);
            if (next < 0 || std::exchange(seen[next], 1)) continue;
            visit(front[i], corner);
            front.push_back(next);
        }
    }
    return seen;
}

/// Each tetrahedron is split in eight, again and again, until there are at least so many.
/// @throws InvalidInput when the body is in several pieces.
TetGraph make_tet_graph(const mesh::VolumeMesh& body, int least);

/// Length of the shortest path over neighbours from the given tetrahedra to each (m) [mm]; they lie `at` (m x 3).
Eigen::VectorXd path_lengths(const TetGraph& graph, const Points& at, const std::vector<int>& from);

}  // namespace palpate::skeleton
