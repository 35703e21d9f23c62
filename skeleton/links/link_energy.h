#pragma once

#include <array>

#include "skeleton/model/model.h"

namespace palpate::skeleton {

using Vec12 = Eigen::Matrix<double, 12, 1>;
using Mat12 = Eigen::Matrix<double, 12, 12>;

/// Where the steps of a link's two ends lie in a Vec12.
inline constexpr int dx_a = 0, w_a = 3, dx_b = 6, w_b = 9;

/// A link as it stands: x_b - x_a = l n.
struct LinkAxis {
    double l;  // [mm]
    Vec3 n;    // unit
};
/// @throws SolverFailure when the ends coincide; `length`: at rest [mm].
LinkAxis link_axis(double length, const Vec3& x_a, const Vec3& x_b);

/// A link's energies at unit stiffness, ordered as its stiffnesses (n = 3 or 6), and their derivatives by the step of
/// its two ends (dx_a, w_a, dx_b, w_b).
struct LinkTerms {
    Stiffnesses energy;                                            // (n) [mm^2 or rad^2]
    Eigen::Matrix<double, 12, Eigen::Dynamic, 0, 12, 6> gradient;  // (12 x n)
    std::array<Mat12, 6> hessian;  // n of them, in exponential coordinates at the state: symmetric; filled on demand
};

/// Those of the paper's link:
///   elongation  1/2 (|x_b - x_a| - L)^2
///   flexion     1/2 (theta_a^2 + theta_b^2), theta: angle between the link and the direction that an end carries
///   torsion     1/2 tau^2, tau: twist of R_a^T R_b about the link's rest direction
/// The link's energy is kE e_E + kF e_F + kT e_T, so its forces are linear in the stiffnesses. All are conservative;
/// a rigid motion changes none. `rest_direction`: unit vector from a to b at rest, where both rotations are the
/// identity.
/// @throws SolverFailure when the ends coincide.
LinkTerms link_terms(double length, const Vec3& rest_direction, const Vec3& x_a, const Mat3& R_a, const Vec3& x_b,
                     const Mat3& R_b, bool with_hessian);

/// kE H_E + kF H_F + kT H_T of link_terms, at a third of the cost [N/mm, N, N mm].
Mat12 link_hessian(const Vec3& stiffness, double length, const Vec3& rest_direction, const Vec3& x_a, const Mat3& R_a,
                   const Vec3& x_b, const Mat3& R_b);

}  // namespace palpate::skeleton
