#pragma once

#include <memory>

#include "fem/rig/rigid_shape.h"
#include "mesh/core/tool.h"

namespace palpate::fem {

/// The shape of a tool; null for a grip, which has none.
/// @throws InvalidInput for a radius that is not positive, or a surface that is not closed.
std::shared_ptr<const RigidShape> tool_shape(const mesh::Tool& tool);

}  // namespace palpate::fem
