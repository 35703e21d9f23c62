#pragma once

#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

/// The inner nodes of a body of quadratic tetrahedra follow its boundary: `moves` (n x 3) [mm] with the rows of the
/// inner nodes filled in, so that each is the mean of its neighbours', weighted by 1/distance.
/// @throws SolverFailure when the iteration does not converge.
Points follow_boundary(const VolumeMesh& body, const Points& moves);

}  // namespace palpate::mesh
