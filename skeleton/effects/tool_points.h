#pragma once

#include "fem/rig/tool_potential.h"
#include "skeleton/effects/point_sets.h"

namespace palpate::skeleton {

/// The points of a skeleton that a tool may touch, or holds, weighed by how stiffly [N/mm]; those that it never feels
/// are left out.
///   a shape: the skin's vertices, as fem::ToolPotential weighs them
///   a grip: the skin's vertices in its regions, and of each sphere with its centre there the six points where the axes
///     meet it, so that it is kept from turning
/// @throws InvalidInput as fem::ToolPotential::weights, or where a shape meets a model without a skin.
PointSet tool_points(const Model& model, const fem::ToolPotential& tool);

}  // namespace palpate::skeleton
