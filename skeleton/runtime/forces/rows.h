#pragma once

#include <Eigen/Geometry>

#include "mesh/types.h"
#include "skeleton/runtime/kernels/tables.h"

// A sphere's row (SphereRows) as vectors.

namespace palpate::runtime {

/// The first half: centre, velocity, momentum or force.
inline Eigen::Map<const Vec3> moves_of(const double* rows, int sphere) {
    return Eigen::Map<const Vec3>(rows + row_length * sphere);
}
inline Eigen::Map<Vec3> moves_of(double* rows, int sphere) { return Eigen::Map<Vec3>(rows + row_length * sphere); }

/// The second half: angular velocity, angular momentum or torque.
inline Eigen::Map<const Vec3> turns_of(const double* rows, int sphere) {
    return Eigen::Map<const Vec3>(rows + row_length * sphere + 4);
}
inline Eigen::Map<Vec3> turns_of(double* rows, int sphere) { return Eigen::Map<Vec3>(rows + row_length * sphere + 4); }

/// The second half of a pose.
inline Eigen::Quaterniond orientation_of(const double* pose, int sphere) {
    return Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(pose + row_length * sphere + 4));
}

}  // namespace palpate::runtime
