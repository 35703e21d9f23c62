#pragma once

#include <vector>

#include "mesh/geometry/surface_tree.h"
#include "skeleton/construction/placement/body.h"
#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// The spheres of the sites: as large as the body is thick there and not through its free surface; in plates and lumps
/// they hardly overlap.
std::vector<Sphere> make_spheres(const PlacementBody& body, const mesh::SurfaceTree& tree,
                                 const std::vector<mesh::Region>& supports, const std::vector<Site>& sites,
                                 double spacing);

/// How far each point lies outside the union of the spheres (n), negative inside [mm].
Eigen::VectorXd outside(const std::vector<Sphere>& spheres, const Points& points);

/// Lets spheres swell, by half of `delta` at most, where they are nearest to a point further than delta outside: a ball
/// in a square bar does not reach the edges.
void swell(const Points& points, double delta, std::vector<Sphere>& spheres);

/// Sites for the points further than `delta` outside the spheres: few medial balls that hold, when swollen, all that
/// can be held; each the one that holds most of those still outside, ties go to the larger, then to the first. [Dou et
/// al. 2022, Coverage Axis] None stands within `gap` of another site.
std::vector<Site> covering_sites(const PlacementBody& body, const std::vector<mesh::Region>& supports,
                                 const std::vector<Site>& sites, const std::vector<Sphere>& spheres,
                                 const Points& points, double delta, double gap);

}  // namespace palpate::skeleton
