#pragma once

#include <set>
#include <utility>
#include <vector>

#include "mesh/surface_tree.h"
#include "skeleton/placement/body.h"
#include "skeleton/placement/handles.h"

namespace palpate::skeleton {

/// Whether the links between cells can follow the body.
struct Mending {
    std::vector<Site> wanted;                 // to be asked again with these among the sites
    std::set<std::pair<int, int>> dispensed;  // cells a < b that meet, but are linked by a third one as well
};

/// More sites are wanted in cells that close on themselves round a handle, where two cells meet on both sides of one,
/// and where the straight way between cells that meet leads further than `tolerance` [mm] and a tenth of its
/// length outside, unless a third cell links them on the same side of all handles: then they need no link.
Mending find_mending(const Body& body, const mesh::SurfaceTree& tree, const Handles& handles,
                     const std::vector<int>& owner, const std::vector<Site>& sites, double tolerance);

}  // namespace palpate::skeleton
