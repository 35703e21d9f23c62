#pragma once

#include <Eigen/SparseCore>

#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// Weights N such that field(points) = N * field(nodes) (p x n), rows add up to 1.
///
/// Shape functions of the element that holds the point. A point outside takes those of the nearest element,
/// evaluated at the point itself where it lies within half an edge, else at the nearest point of the element.
Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation(const mesh::VolumeMesh& mesh, const Points& points);

}  // namespace palpate::fem
