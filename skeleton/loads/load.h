#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "skeleton/loads/cavities.h"

namespace palpate::skeleton {

/// A dead force at an attached point [N].
struct PointForce {
    Attachment at;
    Vec3 force;
};

/// A force that is spread over a patch of the surface: what dents are made of.
struct PatchForce {
    Vec3 force = Vec3::Zero();                   // [N]
    Vec3 normal = Vec3::Zero();                  // of the surface there, outward, unit
    double radius = 0;                           // [mm], > 0
    std::vector<std::pair<Vec3, double>> patch;  // points of it at rest and their shares, at least one
};

/// What acts on a skeleton from outside.
struct Load {
    std::vector<PointForce> forces;
    std::vector<PatchForce>
        patch_forces;             // the same forces where they dent the surface; they do no work on the spheres
    Vec3 gravity = Vec3::Zero();  // [mm/s^2], on the spheres' masses
    double pressure = 0;          // in the skin's cavities [MPa], beside what the effects in force bring about there
    std::shared_ptr<const Cavities> cavities = nullptr;  // of the skin, where there is pressure
};

/// External generalized force (6N) [N, N mm]: forces and torques on the spheres, by virtual work.
Eigen::VectorXd external_force(const Model& model, const State& state, const Load& load);

/// Work on the way from rest [N mm], of pressure too; external_force is its derivative.
double external_work(const Model& model, const State& state, const Load& load);

/// A block (a, b) of a second derivative by the steps of two spheres, a <= b; where a < b its transpose stands at (b,
/// a).
struct CurvatureBlock {
    int a = 0, b = 0;
    Eigen::Matrix<double, 6, 6> block;
};

/// Second derivative of the work by the step, in exponential coordinates: dead forces on lever arms turn against them,
/// and pressure turns with the walls.
/// Blocks of the same spheres add up.
std::vector<CurvatureBlock> external_curvature(const Model& model, const State& state, const Load& load);

}  // namespace palpate::skeleton
