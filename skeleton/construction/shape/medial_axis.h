#pragma once

#include "mesh/core/surface.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::skeleton {

/// Largest balls inside a body: their centres sample its medial axis.
struct MedialAxis {
    Points centers;         // (n x 3) [mm]
    Eigen::VectorXd radii;  // (n) distance from the centre to the surface [mm], > 0
    Points touching;        // a surface point that each ball touches (n x 3) [mm]
};

/// The medial balls that touch a closed surface, about one for each patch of `spacing` [mm] a side, however fine its
/// triangles are.
///
/// From the middle of each patch the largest ball that touches it from inside grows: a huge one is shrunk until no
/// other part of the surface lies in it [Ma, Bae, Choi 2012]. Distances are to the surface itself by CGAL's tree of
/// boxes, not to samples of it, so walls thinner than the spacing come out right; poles of Voronoi cells, the usual
/// recipe, need samples closer than the thinnest wall is thick, and each pole's radius by the tree all the same. Steps
/// that only follow the facets of a rounded surface are not taken [Peters 2018], nor those that follow its bumps:
/// patches look where they look on the whole, and touching points nearer than `spacing` must face each other.
/// The same surface gives the same balls.
MedialAxis medial_axis(const mesh::Surface& surface, const mesh::SurfaceTree& tree, double spacing);

}  // namespace palpate::skeleton
