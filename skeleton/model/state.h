#pragma once

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

/// exp of the skew matrix of w: the rotation by |w| about w. [Rodrigues]
Mat3 rotation(const Vec3& w);
/// Its inverse; the angle lies in [0, pi].
Vec3 rotation_vector(const Mat3& R);
Mat3 skew(const Vec3& w);

}  // namespace palpate::skeleton
