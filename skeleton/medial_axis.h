#pragma once

#include "mesh/surface.h"
#include "mesh/surface_tree.h"

namespace palpate::skeleton {

/// Largest balls inside a body: their centres sample its medial axis.
struct MedialAxis {
    Points centers;         // (n x 3) [mm]
    Eigen::VectorXd radii;  // (n) distance from the centre to the surface [mm], > 0
    Points touching;        // the surface point that each ball was started from (n x 3) [mm]
};

/// The medial balls that touch a closed surface, about one for each patch of `spacing` [mm] a side.
///
/// Each sample of the surface grows the largest ball that touches it from inside: a huge one is shrunk until no other
/// part of the surface lies in it [Ma, Bae, Choi 2012]. Distances are to the surface itself, not to samples of it, so
/// walls thinner than the spacing come out right. Steps that only follow the facets of a rounded surface are not
/// taken [Peters 2018]. The same surface gives the same balls.
MedialAxis medial_axis(const mesh::Surface& surface, const mesh::SurfaceTree& tree, double spacing);

}  // namespace palpate::skeleton
