#pragma once

#include <memory>

#include "fem/rig/rigid_shape.h"
#include "mesh/core/tool.h"

namespace palpate::fem {

/// A ball. @pre radius > 0.
std::shared_ptr<const RigidShape> ball_shape(const Vec3& centre, double radius);

/// A half-infinite cylinder behind its flat face: within, the nearer of face and side counts, but for points that it
/// finds below its face: those stay there. @pre radius > 0, axis other than 0.
std::shared_ptr<const RigidShape> punch_shape(const Vec3& centre, const mesh::FlatShape& punch);

}  // namespace palpate::fem
