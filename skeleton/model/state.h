#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// A configuration of the spheres. A step of it is (6N): for each sphere a displacement, then a rotation vector
/// in space: x += dx, R <- exp([w]) R.
struct State {
    Points x;             // centres (N x 3) [mm]
    std::vector<Mat3> R;  // rotations (N)
};

State rest_state(const Model& model);
State advance(const State& state, const Eigen::VectorXd& step);

/// The rotation by |w| about w, exp(i w/2) as a unit quaternion: (cos |w|/2, sin(|w|/2) w/|w|), whose norm is 1 however
/// small w is. Below 1e-9, sin(x)/x is 1 in double precision.
inline Eigen::Quaterniond quaternion_of(const Vec3& w) {
    const double half = 0.5 * w.norm();
    const double sinc = half > 1e-9 ? std::sin(half) / half : 1.0;
    const Vec3 v = 0.5 * sinc * w;
    return {std::cos(half), v.x(), v.y(), v.z()};
}
/// exp of the skew matrix of w: the same as a matrix. [Rodrigues]
Mat3 rotation(const Vec3& w);
/// Its inverse; the angle lies in [0, pi].
Vec3 rotation_vector(const Mat3& R);
Mat3 skew(const Vec3& w);

}  // namespace palpate::skeleton
