#pragma once

#include <vector>

#include "skeleton/construction/shape/core.h"

namespace palpate::skeleton {

/// A place where a sphere will stand.
struct Site {
    Vec3 at = Vec3::Zero();  // on the core [mm]
    int tet = 0;             // the tetrahedron that its cell grows from
    bool held = false;       // in a support
    bool extra = false;      // covers a part of the surface by itself: stands off the core, where it was put
};

/// Shares the body out between the sites: the site of each tetrahedron (m).
///
/// Cells grow from their sites through neighbours, nearest first on the core, so that each hangs together and none
/// reaches across a gap; elsewhere they are Voronoi cells. Extra sites take what is nearer to them in the body itself.
/// Held material goes to held sites.
std::vector<int> grow_cells(const TetGraph& graph, const Core& core, const std::vector<char>& held,
                            const std::vector<Site>& sites);

/// Adds `count` free sites, each where the body is furthest from all sites so far. [Gonzalez 1985]
/// @throws InvalidInput when the body has no place for so many.
void add_sites(const TetGraph& graph, const Core& core, const std::vector<char>& held, int count,
               std::vector<Site>& sites);

/// Moves the free sites of the core to the middles of their cells, until they rest [Lloyd 1982]. Those left with next
/// to nothing of the `shares` (m, of a sphere each) are put where the largest cell has room, and all rest again.
void relax_sites(const TetGraph& graph, const Core& core, const std::vector<char>& held, double spacing,
                 const Eigen::VectorXd& shares, std::vector<Site>& sites);

}  // namespace palpate::skeleton
