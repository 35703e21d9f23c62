#include "skeleton/model/state.h"

#include <cassert>
#include <cmath>

namespace palpate::skeleton {

State rest_state(const Model& model) {
    State state;
    state.x.resize(static_cast<Eigen::Index>(model.spheres.size()), 3);
    for (size_t i = 0; i < model.spheres.size(); ++i) state.x.row(i) = model.spheres[i].center.transpose();
    state.R.assign(model.spheres.size(), Mat3::Identity());
    return state;
}

State advance(const State& state, const Eigen::VectorXd& step) {
    assert(step.size() == 6 * state.x.rows());
    State next = state;
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
        next.x.row(i) += step.segment<3>(6 * i).transpose();
        next.R[i] = rotation(step.segment<3>(6 * i + 3)) * state.R[i];
    }
    return next;
}

Mat3 skew(const Vec3& w) {
    Mat3 W;
    W << 0, -w.z(), w.y(),  //
        w.z(), 0, -w.x(),   //
        -w.y(), w.x(), 0;
    return W;
}

Mat3 rotation(const Vec3& w) { return quaternion_of(w).toRotationMatrix(); }

Vec3 rotation_vector(const Mat3& R) {
    Eigen::Quaterniond q(R);
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    const double sine = q.vec().norm();
    // Below it the quotient is 2 in double precision.
    const double scale = sine > 1e-12 ? 2 * std::atan2(sine, q.w()) / sine : 2.0;
    return scale * q.vec();
}

}  // namespace palpate::skeleton
