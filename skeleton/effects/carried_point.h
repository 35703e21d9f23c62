#pragma once

#include <array>

#include "skeleton/state.h"

namespace palpate::skeleton {

/// A sphere's share in carrying a point: w (x + r), r = R (rest - X).
struct CarriedShare {
    int sphere = 0;
    double w = 0;
    Vec3 r = Vec3::Zero();  // the arm, as it stands [mm]

    /// How the point moves with a step of the sphere.
    Eigen::Matrix<double, 3, 6> jacobian() const {
        Eigen::Matrix<double, 3, 6> J;
        J << w * Mat3::Identity(), -w * skew(r);
        return J;
    }
};

/// An attached point in a state, and the one or two spheres that carry it.
struct CarriedPoint {
    Vec3 x = Vec3::Zero();  // [mm]
    std::array<CarriedShare, 2> of;
    int shares = 0;
};

inline CarriedPoint carried(const Attachment& point, const State& rest, const State& state) {
    CarriedPoint result;
    const auto add = [&](int sphere, double w) {
        if (w == 0) return;
        const Vec3 r = state.R[sphere] * (point.rest - rest.x.row(sphere).transpose());
        result.of[result.shares++] = {sphere, w, r};
        result.x += w * (state.x.row(sphere).transpose() + r);
    };
    if (point.a == point.b) {
        add(point.a, 1);
    } else {
        add(point.a, 1 - point.t);
        add(point.b, point.t);
    }
    return result;
}

/// Second derivative by w of f . r, where the arm r turns to r + w x r + 1/2 w x (w x r), in exponential coordinates.
inline Mat3 turning_curvature(const Vec3& f, const Vec3& r) {
    const Mat3 fr = 0.5 * f * r.transpose();
    return fr + fr.transpose() - f.dot(r) * Mat3::Identity();
}

}  // namespace palpate::skeleton
