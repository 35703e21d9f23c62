#pragma once

#include "mesh/types.h"

namespace palpate::mesh {

/// A force on the body, spread evenly over its surface within `radius` of `point`
/// (radius 0: the nearest surface point).
struct Contact {
    Vec3 point = Vec3::Zero();  // [mm]
    Vec3 force = Vec3::Zero();  // [N]
    double radius = 0.0;        // [mm]
};

}  // namespace palpate::mesh
