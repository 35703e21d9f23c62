#pragma once

#include <vector>

#include "skeleton/construction/shape/medial_axis.h"
#include "skeleton/construction/shape/tet_graph.h"

namespace palpate::skeleton {

/// The part of space round a medial ball: which way the body runs on there, and which way it is thin.
struct Neighborhood {
    Vec3 middle = Vec3::Zero();     // of the body nearby [mm]
    Mat3 along = Mat3::Identity();  // projects on the directions in which the body runs on
    int dimensions = 3;             // of those: 1 in a limb, 2 in a plate, 3 in a lump
    double radius = 0;              // of the largest ball in there: half the thickness [mm]

    /// What a sphere on the core has across: a limb's section [mm^2], a plate's thickness [mm], 1 in a lump.
    double section() const;
    Vec3 collapse(const Vec3& point) const { return middle + along * (point - middle); }
};

/// A body with its thin directions collapsed: limbs to their axes, plates to their middle sheets, lumps as they are.
/// Spheres that are spread over the core stand in single file in limbs, in one layer in plates, and fill lumps.
struct Core {
    std::vector<Neighborhood> neighborhoods;
    std::vector<int> neighborhood;  // of each tetrahedron (m)
    Points at;                      // where each tetrahedron's centre collapses to (m x 3) [mm]

    const Neighborhood& of(int tet) const { return neighborhoods[neighborhood[tet]]; }
};

Core find_core(const TetGraph& graph, const MedialAxis& axis);

/// The same radii, nothing collapsed: for filling a body however thin it is.
Core fill_core(const TetGraph& graph, const Core& core);

/// How much of a sphere each tetrahedron asks for (m), when spheres stand `spacing` [mm] from each other on the core;
/// the sum is their number. `volumes` [mm^3]: of the tetrahedra that count (m).
Eigen::VectorXd sphere_shares(const Eigen::VectorXd& volumes, const Core& core, double spacing);

/// The spacing at which `spheres` fit on the core [mm].
double spacing_of_spheres(const Eigen::VectorXd& volumes, const Core& core, int spheres);

/// A good number of spheres for the shape: 120 for a lump, 60 for a plate, 10 to 20 for a limb; parts count by their
/// share, those of next to nothing not at all. `reach`: the longest way from the support along the core [mm].
int default_spheres(const TetGraph& graph, const Eigen::VectorXd& volumes, const Core& core, double reach);

/// Mean of the largest balls' radii over the volume [mm].
double mean_radius(const Eigen::VectorXd& volumes, const Core& core);

}  // namespace palpate::skeleton
