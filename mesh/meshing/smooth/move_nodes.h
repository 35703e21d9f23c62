#pragma once

#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

/// A body of quadratic tetrahedra with its nodes moved by `moves` (n x 3) [mm]. Where det J would fall below a fifth
/// of the straight element's, at a node or a quadrature point, the element's nodes move half as far, again and again,
/// at last not at all.
VolumeMesh move_nodes(const VolumeMesh& body, const Points& moves);

}  // namespace palpate::mesh
