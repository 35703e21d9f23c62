#pragma once

#include <set>
#include <utility>
#include <vector>

#include "mesh/geometry/surface_tree.h"
#include "skeleton/construction/placement/body.h"
#include "skeleton/construction/shape/handles.h"

namespace palpate::skeleton {

/// Topological defects of the link graph with respect to the body.
struct TopologyRepair {
    std::vector<Site> required_sites;  // additional sites; to be checked again with them
    std::set<std::pair<int, int>>
        redundant;  // redundant links: adjacent cells a < b that a third cell connects as well
};

/// More sites are wanted in cells that close on themselves round a handle, where two cells meet on both sides of one,
/// and where the straight way between cells that meet leads further than `tolerance` [mm] and a tenth of its
/// length outside, unless a third cell links them on the same side of all handles: then they need no link.
TopologyRepair find_topology_repair(const PlacementBody& body, const mesh::SurfaceTree& tree, const Handles& handles,
                                    const std::vector<int>& owner, const std::vector<Site>& sites, double tolerance);

}  // namespace palpate::skeleton
