#pragma once

#include <array>
#include <vector>

#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// A quadratic face of a body's boundary, and the element behind it.
struct BoundaryFace {
    int element = 0;
    std::array<int, 6> node{}, local{};  // in the mesh, in the element
};

/// The vectors of a face's nodes, a column each.
using FaceNodes = Eigen::Matrix<double, 3, 6>;

/// Some of a quadratic mesh's faces, by their numbers.
std::vector<BoundaryFace> boundary_faces_with_elements(const mesh::VolumeMesh& mesh, const std::vector<int>& faces);

/// Where a face's nodes stand, which rest at `nodes` (n x 3), in the displacement u (3n).
FaceNodes positions(const BoundaryFace& face, const Points& nodes, const Eigen::VectorXd& u);

}  // namespace palpate::fem
