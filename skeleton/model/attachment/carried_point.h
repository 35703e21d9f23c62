#pragma once

#include <vector>

#include "skeleton/model/state.h"

namespace palpate::skeleton {

/// Where an attached point is in a state, without the derivatives that a CarriedPoint holds.
Vec3 carried_place(const Attachment& point, const State& rest, const State& state);

/// An attached point in a state: where it is, and how it moves with the spheres that carry it.
///
/// With weights w_i the spheres' mean place is x = sum w_i x_i and their mean turn the unit quaternion q along
/// sum w_i q_i. Against that mean motion a sphere has moved by R^T (x_i - x) - (X_i - X) and turned by 2 v_i, v_i the
/// vector part of q^-1 q_i, and
///   p = x + R (rest - X + sum_i C_i (moved_i, turned_i)).
/// C_i is what `follow` has beyond the mean motion, so that to first order the point moves as `follow` says; a twist or
/// a bend between the spheres turns it with their mean, and does not pull it inwards as a mean of positions would.
class CarriedPoint {
public:
    using Jacobian = Eigen::Matrix<double, 3, 6>;

    CarriedPoint(const Attachment& point, const State& rest, const State& state);

    const Vec3& x() const { return x_; }  // [mm]
    int shares() const { return static_cast<int>(of_.size()); }
    int sphere(int share) const { return of_[share].sphere; }
    /// How the point moves with a step of that sphere.
    const Jacobian& jacobian(int share) const { return of_[share].jacobian; }
    /// Second derivative of f . x by the steps of all shares, in exponential coordinates (6k x 6k).
    Eigen::MatrixXd curvature(const Vec3& f) const;

private:
    struct Carrier {
        int sphere;
        double w;  // weight
        Vec3 y;    // x_i - x [mm]
        double c;  // (c, v): q_i q^-1
        Vec3 v;
        Mat3 moves, turns;  // C_i, in space
        Mat3 mean_turn;     // how the mean turn follows that of the sphere
        Jacobian jacobian;
    };
    std::vector<Carrier> of_;
    Vec3 x_;
    Vec3 arm_;      // p - x [mm]
    double n_ = 1;  // |sum w_i q_i|
};

}  // namespace palpate::skeleton
