#pragma once

#include <Eigen/SparseCore>

#include "fem/elements/dilatation.h"
#include "fem/material.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Stiffness matrix K of a linearly elastic body (3n x 3n), symmetric, both halves [N/mm];
/// degree of freedom 3 i + c is component c of node i.
/// @throws InvalidInput for linear elements with nu > 0.4, which lock (26 % too stiff at nu = 0.49).
SparseMatrix stiffness(const mesh::VolumeMesh& mesh, const Material& material, Dilatation dilatation);

/// Consistent nodal forces of gravity (3n) [N]; g [mm/s^2].
Eigen::VectorXd gravity_load(const mesh::VolumeMesh& mesh, double density, const Vec3& g);

}  // namespace palpate::fem
