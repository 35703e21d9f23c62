#pragma once

#include "skeleton/links/link_energy.h"

namespace palpate::skeleton {

/// The energy of a link's shear at unit stiffness:
///   1/2 |y|^2,  y = L/2 (d_a + d_b) x n,
/// y the offset of the ends [mm] across the mean of the directions d_a, d_b that they carry, n the link's own. Both
/// ends turned alike against the link cost it; pure bending, which turns them against one another, does not, nor does a
/// rigid motion. For small angles alpha of the ends |y| = L |alpha_a + alpha_b| / 2.
class Shear {
public:
    /// @throws SolverFailure when the ends coincide.
    Shear(double length, const Vec3& rest_direction, const Vec3& x_a, const Mat3& R_a, const Vec3& x_b,
          const Mat3& R_b);

    double energy() const { return 0.5 * y_.squaredNorm(); }  // [mm^2]
    /// Adds k times its derivative by the step of the two ends.
    void add_gradient(double k, Eigen::Ref<Vec12> g) const { g += k * J_.transpose() * y_; }
    /// Adds k times the second, in exponential coordinates.
    void add_hessian(double k, Mat12& H) const;

private:
    double length_, l_;  // at rest, now [mm]
    Vec3 n_, d_a_, d_b_;
    Vec3 y_;
    Eigen::Matrix<double, 3, 12> J_;  // dy / d step
};

}  // namespace palpate::skeleton
