#pragma once

#include <optional>

#include "skeleton/links/link_energy.h"
#include "skeleton/model/link_pose.h"
#include "skeleton/model/state.h"

namespace palpate::skeleton {

/// A full link as it stands: two rigid halves that meet in the section's centroid, and what keeps them together there.
///
/// Half a ends at p_a = x_a + R_a (at - X_a), half b likewise; at rest both lie in the section's centroid. The ends
/// part by d = p_b - p_a and turn by the rotation R_b R_a^T = (w, v), a unit quaternion with w >= 0. In the section's
/// axes f_0 along the link, f_1 and f_2 across, as both halves carry them on average,
///   elongation  s = (R_a f_0 + R_b f_0) / 2 . d, less what the link's rest length differs from the spheres' distance
///   shear       s = (R_a f_1 + R_b f_1) / 2 . d,  shear_2 with f_2      [mm]
///   torsion     s = 2 v . R_a f_0                                       [rad]
///   flexion     s = 2 v . R_a f_2, in the plane of shear,  flexion_2 with f_1
/// each less its natural strain, where its material has grown unevenly (LinkSection::natural).
/// The energy of each is 1/2 k s^2: conservative, the same after any rigid motion, and polynomial in rotations: 2 |v|
/// is twice the sine of half the angle. A straight beam's segment with k = E A / L, E I / L, G J / L and, across, 1 /
/// (L / (kappa G A) + L^3 / (12 E I)) is exact for small displacements of its ends.
///
/// The same law stands in skeleton/runtime/kernels/link_forces.h for vector units (held to this one by
/// tests/skeleton/runtime/forces/force_field_test.cpp, 1e-12) and in pipeline/exports/sofa_law.h in numpy (by
/// SofaExport.ItsForcesAreTheModels): whoever changes one changes all.
class FullLink {
public:
    using Strains = Eigen::Matrix<double, 6, 1>;

    /// `X_a`, `X_b`: the spheres' centres at rest; `length`: the link's at rest [mm].
    FullLink(const LinkSection& section, double length, const Vec3& X_a, const Vec3& X_b, const Vec3& x_a,
             const Mat3& R_a, const Vec3& x_b, const Mat3& R_b);

    /// Makes of its strains s the strains C s, so that the energy of each is 1/2 k (C s)^2: a section whose material
    /// couples them (SectionLaw). @pre C has ones on its diagonal and nothing below.
    void couple(const Eigen::Matrix<double, 6, 6>& C);

    /// s, ordered as Stiffness.
    const Strains& strains() const { return strains_; }
    /// d s / d step of the link's two ends, a column each.
    const Eigen::Matrix<double, 12, 6>& gradients() const { return gradients_; }
    /// Adds sum_j factor_j d^2 s_j / d step^2, in exponential coordinates.
    void add_curvature(const Strains& factors, Mat12& H) const;
    /// Adds the second derivative of sum_j k_j s_j^2 / 2.
    void add_hessian(const Strains& k, Mat12& H) const;

private:
    Vec3 arm_a_, arm_b_, gap_;                             // R_a (at - X_a), R_b (at - X_b), d
    Mat3 axes_a_, axes_b_;                                 // columns R_a f_i, R_b f_i
    Mat3 turns_;                                           // columns: how 2 v . R_a f_i changes with w_b - w_a
    Vec3 halves_;                                          // v . R_a f_i
    std::optional<Eigen::Matrix<double, 6, 6>> coupling_;  // C
    Strains strains_;
    Eigen::Matrix<double, 12, 6> gradients_;
};

/// A link of a model as its ends are; `rest`: the model's state. @pre the link is full.
FullLink full_link(const Link& link, const State& rest, const LinkPose& ends);

/// Energies of a full link at unit stiffness, and their derivatives.
LinkTerms full_link_terms(const FullLink& link, bool with_hessian);

}  // namespace palpate::skeleton
