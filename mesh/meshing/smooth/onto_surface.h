#pragma once

#include "mesh/core/volume_mesh.h"
#include "mesh/meshing/smooth/bulges.h"

namespace palpate::mesh {

/// How the boundary nodes of a body of quadratic tetrahedra get onto the bulging surface: each to the place above its
/// nearest point, nodes along the body's creases to the surface's creases; zero for inner nodes (n x 3) [mm].
/// Nodes whose nearest facet looks the other way (thin parts) stay.
Points moves_onto(const VolumeMesh& body, const Surface& surface, const Bulges& bulges, double crease_angle);

}  // namespace palpate::mesh
