#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "mesh/region.h"
#include "mesh/surface.h"
#include "mesh/types.h"
#include "skeleton/effects/effect.h"

namespace palpate::skeleton {

/// A filling sphere: a rigid node of the skeleton. [Conti, Khatib, Baur 2003]
struct Sphere {
    Vec3 center = Vec3::Zero();   // at rest [mm]
    double radius = 0;            // [mm]
    double mass = 0;              // of its share of the body [tonne]
    Mat3 inertia = Mat3::Zero();  // of that share about the centre [tonne mm^2]
    bool held = false;            // stands in a support: neither moves nor turns, unless an effect holds the body there
};

/// The three stiffnesses of a link, in this order everywhere.
enum class Stiffness { elongation, flexion, torsion };
inline constexpr std::array<const char*, 3> stiffness_names{"elongation", "flexion", "torsion"};
inline constexpr std::array<const char*, 3> stiffness_units{"N/mm", "N*mm/rad", "N*mm/rad"};

/// An elastic link between two spheres.
struct Link {
    int a = 0, b = 0;                          // spheres, a < b
    double length = 0;                         // at rest [mm]
    Eigen::Vector3d stiffness = Vec3::Zero();  // kE [N/mm], kF [N mm/rad], kT [N mm/rad]
    int zone = 0;         // links of a zone share their stiffness multipliers when identified by zones
    double gyration = 0;  // radius of gyration of its section [mm]; 0: as flexion and elongation have it
};

/// Where a point of the body hangs: on the nearest sphere (a == b, or t = 0, 1) or link. It follows
/// p = (1 - t) (x_a + R_a (rest - X_a)) + t (x_b + R_b (rest - X_b)): exact for rigid motions.
struct Attachment {
    int a = 0, b = 0;
    double t = 0;              // [0, 1]
    Vec3 rest = Vec3::Zero();  // [mm]
};

/// How far a model's rotations reach.
enum class Law {
    linear,          // small displacements: one linear step from rest, as other people's linear solvers write
    large_rotation,  // equilibrium of the full energy, as real bodies do
};
inline constexpr std::array<const char*, 2> law_names{"linear", "large-rotation"};

/// A body as spheres joined by elastic links, with a skin, under the effects that are in force.
struct Model {
    std::string name;
    Law law = Law::large_rotation;
    std::vector<Sphere> spheres;
    std::vector<Link> links;
    std::vector<Effect> effects;   // beyond the links; those of a measurement are only recorded
    mesh::Surface surface;         // at rest
    std::vector<Attachment> skin;  // of each vertex of the surface
    std::vector<mesh::Region> supports;
    std::map<std::string, std::string> provenance;  // where it comes from, in words

    int dofs() const { return 6 * static_cast<int>(spheres.size()); }
};

/// Attaches a point: to the nearest link's axis or sphere's centre. Distances are measured to the axes, less the
/// radius there (spheres are cones' ends), so that a thick sphere does not lose its skin to a thin neighbour.
Attachment attach(const Model& model, const Vec3& point);

/// The same, for a point that is rigidly fixed to the surface at `anchor` but stands at `point`.
Attachment attach(const Model& model, const Vec3& anchor, const Vec3& point);

}  // namespace palpate::skeleton
