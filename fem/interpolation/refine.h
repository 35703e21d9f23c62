#pragma once

#include <Eigen/SparseCore>

#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// A body whose elements were each cut into eight.
struct RefinedMesh {
    mesh::VolumeMesh mesh;
    /// A field of the coarse nodes at the fine ones (n' x n).
    Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation;
};

/// Halves the edges of quadratic elements: four of the pieces lie at the corners, the octahedron between them is cut
/// along its shortest diagonal. Curved sides keep their shape, so that the coarse mesh's fields are fields of the fine
/// one. [Bey 1995] @pre `body` is quadratic.
RefinedMesh refine(const mesh::VolumeMesh& body);

}  // namespace palpate::fem
