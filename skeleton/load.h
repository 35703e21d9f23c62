#pragma once

#include <vector>

#include "skeleton/state.h"

namespace palpate::skeleton {

/// A dead force at an attached point [N].
struct PointForce {
    Attachment at;
    Vec3 force;
};

/// What acts on a skeleton from outside.
struct Load {
    std::vector<PointForce> forces;
    Vec3 gravity = Vec3::Zero();  // [mm/s^2], on the spheres' masses
};

/// External generalized force (6N) [N, N mm]: forces and torques on the spheres, by virtual work.
Eigen::VectorXd external_force(const Model& model, const State& state, const Load& load);

/// Work of the dead forces on the way from rest [N mm]; external_force is its derivative.
double external_work(const Model& model, const State& state, const Load& load);

/// Second derivative of the work by the rotation of each sphere (N), in exponential coordinates [N mm]: a dead
/// force on a lever arm turns against it. All other second derivatives are zero.
std::vector<Mat3> external_curvature(const Model& model, const State& state, const Load& load);

}  // namespace palpate::skeleton
