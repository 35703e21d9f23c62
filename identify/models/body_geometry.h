#pragma once

#include <Eigen/Core>
#include <vector>

#include "mesh/core/surface.h"

namespace palpate::identify {

/// A body at rest: its extent, its surface, what it is made of, and where it is held.
struct BodyGeometry {
    double size = 0;            // the largest side [mm]
    bool has_cavities = false;  // closed ones, which can be under pressure
    mesh::Surface surface;      // outward; without triangles where there is none

    Points pieces;                        // those that may be softer or stiffer than the rest: centres (p x 3) [mm]
    std::vector<char> pieces_at_support;  // does a support's border cut the piece? (p)

    Points skin;                 // points of the surface (s x 3) [mm]
    Eigen::VectorXd skin_areas;  // the area that each stands for (s) [mm^2]

    Points material_points;           // points of the material (n x 3) [mm]
    Eigen::VectorXd material_shares;  // the share of the mass that each stands for (n); they add up to 1

    Points support_points;           // points that the supports hold (h x 3) [mm]
    Eigen::VectorXd support_shares;  // their shares (h), which add up to 1
};

}  // namespace palpate::identify
