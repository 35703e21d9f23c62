#pragma once

#include <vector>

#include "mesh/core/region.h"
#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

/// The same body with elements that end at the borders of boxes, spheres and slabs: no edge runs from inside to
/// outside. A body is held by its nodes; held up to the last node before the border, a bar that bends is half an
/// element too long, which changes its deflection more than the elements do.
///
/// Nodes near a border are moved onto it, along the body's surface where they lie on it; the other edges are cut there.
/// A border within 2 % of an edge of a node inside stays where it is, such as one meant to lie on a side of the body;
/// so does that of a PointsRegion, which is as coarse as its points are sparse. Nodes of the boundary come first.
/// @param body of linear tetrahedra
/// @param surface that nodes of the boundary lie on
/// @param fixed nodes that may not be moved (n flags; empty: none)
VolumeMesh follow_borders(const VolumeMesh& body, const std::vector<Region>& regions, const Surface& surface,
                          const std::vector<char>& fixed = {});

}  // namespace palpate::mesh
