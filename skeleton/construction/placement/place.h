#pragma once

#include "mesh/geometry/surface_tree.h"
#include "skeleton/construction/placement/body.h"
#include "skeleton/construction/shape/handles.h"

namespace palpate::skeleton {

/// Places `spheres` free sites, all that are held, and, where links would not follow the body, others between them
/// (topology_repair.h). `exactly`: those count among the spheres, so that fewer are spread evenly; else they come on
/// top, half as many at most.
/// @throws InvalidInput when the body has no place for so many.
std::vector<Site> place_sites(const PlacementBody& body, const mesh::SurfaceTree& tree, const Handles& handles,
                              const std::vector<mesh::Region>& supports, double spacing, double tolerance, int spheres,
                              bool exactly);

/// Adds sites where links would not follow the body, until they do or there are `most` free ones.
void repair_topology(const PlacementBody& body, const mesh::SurfaceTree& tree, const Handles& handles, double tolerance,
                     std::ptrdiff_t most, std::vector<Site>& sites);

std::ptrdiff_t free_sites(const std::vector<Site>& sites);

}  // namespace palpate::skeleton
