#include "skeleton/links/shear.h"

#include <Eigen/Geometry>

#include "skeleton/model/state.h"
#include "skeleton/model/turning_curvature.h"

namespace palpate::skeleton {

// n turns by P (dx_b - dx_a) / l with P = I - n n^T, and d by w x d:
//   dy = L/2 (D x dn + (w_a x d_a + w_b x d_b) x n),  D = d_a + d_b,
// where (w x d) x n = (d n^T - (n . d) I) w.
Shear::Shear(double length, const Vec3& rest_direction, const Vec3& x_a, const Mat3& R_a, const Vec3& x_b,
             const Mat3& R_b)
    : length_(length), d_a_(R_a * rest_direction), d_b_(R_b * rest_direction) {
    const LinkAxis axis = link_axis(length, x_a, x_b);
    l_ = axis.l;
    n_ = axis.n;
    const Vec3 D = d_a_ + d_b_;
    const double half = 0.5 * length;
    y_ = half * D.cross(n_);
    const Mat3 by_dx = (half * skew(D) - y_ * n_.transpose()) / l_;
    const auto by_w = [&](const Vec3& d) -> Mat3 { return half * (d * n_.transpose() - n_.dot(d) * Mat3::Identity()); };
    J_ << -by_dx, by_w(d_a_), by_dx, by_w(d_b_);
}

// J^T J, and with v = y held fixed the second derivatives of v . y = L/2 n . (v x D):
//   by dx, dx: -(q n^T + n q^T + (n . a) P) / l^2,  a = L/2 v x D, q = P a
//   by w, w:   those of L/2 d . (n x v)
//   by w, dx:  L/2 ((v . d) I - v d^T) P / l
void Shear::add_hessian(double k, Mat12& H) const {
    H += k * J_.transpose() * J_;
    const double half = 0.5 * length_;
    const Mat3 P = Mat3::Identity() - n_ * n_.transpose();
    const Vec3 a = half * y_.cross(d_a_ + d_b_), q = P * a;
    const Mat3 qn = q * n_.transpose();
    const Mat3 B = (-k / (l_ * l_)) * (qn + qn.transpose() + n_.dot(a) * P);
    H.block<3, 3>(0, 0) += B;
    H.block<3, 3>(6, 6) += B;
    H.block<3, 3>(0, 6) -= B;
    H.block<3, 3>(6, 0) -= B;
    for (const auto& [d, w] : {std::pair<const Vec3&, int>(d_a_, 3), std::pair<const Vec3&, int>(d_b_, 9)}) {
        H.block<3, 3>(w, w) += turning_curvature(k * half * n_.cross(y_), d);
        const Mat3 M = (k * half / l_) * (y_.dot(d) * Mat3::Identity() - y_ * d.transpose()) * P;
        H.block<3, 3>(w, 6) += M;
        H.block<3, 3>(w, 0) -= M;
        H.block<3, 3>(6, w) += M.transpose();
        H.block<3, 3>(0, w) -= M.transpose();
    }
}

}  // namespace palpate::skeleton
