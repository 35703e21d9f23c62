#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mesh/core/region.h"
#include "mesh/core/surface.h"
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
    double cell = 0;              // volume of its share of the body [mm^3]; 0: not told
    double volume = 0;            // stiffness against changes of that volume [MPa]; 0: none
};

/// The stiffnesses of a model, in this order everywhere. The paper's link has the first three, a full one the first
/// six: flexion and shear in one plane, flexion_2 and shear_2 in the other. The last is a sphere's.
enum class Stiffness { elongation, flexion, torsion, flexion_2, shear, shear_2, volume };
inline constexpr std::array<const char*, 7> stiffness_names{"elongation", "flexion", "torsion", "flexion_2",
                                                            "shear",      "shear_2", "volume"};
inline constexpr std::array<const char*, 7> stiffness_units{"N/mm", "N*mm/rad", "N*mm/rad", "N*mm/rad",
                                                            "N/mm", "N/mm",     "MPa"};
/// The kind whose multiplier a stiffness shares when identified: flexion and shear have one for both planes.
constexpr Stiffness as_identified(Stiffness kind) {
    if (kind == Stiffness::flexion_2) return Stiffness::flexion;
    return kind == Stiffness::shear_2 ? Stiffness::shear : kind;
}
/// Of one link: 3 or 6.
using Stiffnesses = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

/// The section of the body that a full link stands for, at rest.
struct LinkSection {
    Vec3 at = Vec3::Zero();        // its centroid, where the link's two halves meet [mm]
    Mat3 axes = Mat3::Identity();  // rows: along the link; across it in the planes of shear and of shear_2
    double area = 0;               // [mm^2]
    /// Strains at which nothing strains it, as Stiffness orders them [mm, rad]: of material that has grown unevenly. A
    /// model's own has none; elongation has its rest length.
    Eigen::Matrix<double, 6, 1> natural = Eigen::Matrix<double, 6, 1>::Zero();
};

/// An elastic link between two spheres.
struct Link {
    int a = 0, b = 0;                      // spheres, a < b
    double length = 0;                     // at rest [mm]
    Stiffnesses stiffness = Vec3::Zero();  // as many as the kind of link has
    int zone = 0;                          // links of a zone share their stiffness multipliers when identified by zones
    double gyration = 0;                 // radius of gyration of its section [mm]; 0: as flexion and elongation have it
    std::optional<LinkSection> section;  // of a full link
};

/// A sphere's share in carrying a point.
struct SphereInfluence {
    int sphere = 0;
    double weight = 0;  // of the sphere in the mean motion
    Eigen::Matrix<double, 3, 6> follow =
        Eigen::Matrix<double, 3, 6>::Zero();  // d point / d step of the sphere, at rest
};

/// Where a point of the body hangs: on one sphere or several, whose weights add up to 1. It follows their mean motion
/// rigidly, and beside that what `follow` says of how they move against one another: see CarriedPoint. Rigid motions of
/// all are followed exactly.
struct Attachment {
    std::vector<SphereInfluence> shares;  // at least one
    Vec3 rest = Vec3::Zero();             // [mm]
};

/// How far a model's rotations reach.
enum class EquilibriumLaw {
    linear,          // small displacements: one linear step from rest, as other people's linear solvers write
    large_rotation,  // equilibrium of the full energy, as real bodies do
};
inline constexpr std::array<const char*, 2> law_names{"linear", "large-rotation"};

/// How motion dies away: forces -alpha m v on every sphere, and in every link beta times the rate of what it resists.
/// A mode of angular frequency w has the damping ratio (alpha / w + beta w) / 2. [Rayleigh]
struct RayleighDamping {
    double alpha = 0;  // [1/s], >= 0
    double beta = 0;   // [s], >= 0
};

/// A body as spheres joined by elastic links, with a skin, under the effects that are in force.
struct Model {
    std::string name;
    EquilibriumLaw law = EquilibriumLaw::large_rotation;
    std::vector<Sphere> spheres;
    std::vector<Link> links;
    std::vector<EffectRecord> effects;  // beyond the links; those of a measurement are only recorded
    mesh::Surface surface;              // at rest
    std::vector<Attachment> skin;       // of each vertex of the surface
    Eigen::Matrix<double, 6, 1> dent = Eigen::Matrix<double, 6, 1>::Zero();  // amplitudes, see dent_motions [1/MPa]
    std::optional<RayleighDamping> damping;                                  // as it was identified
    std::vector<mesh::Region> supports;
    std::map<std::string, std::string> provenance;  // where it comes from, in words

    int dofs() const { return 6 * static_cast<int>(spheres.size()); }
};

}  // namespace palpate::skeleton
