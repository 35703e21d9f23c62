#pragma once

#include <string>

#include "mesh/topology/shells.h"

namespace palpate::identify {

/// The closed cavity of a body that a point lies in, or is nearest to; its triangles are rows of the surface after
/// welding. `what` begins a message: "actuator 'left'".
/// @throws InvalidInput where the shell there is open, the body has no cavity, or none is within 5 % of its length.
mesh::Shell nearest_cavity(const mesh::Surface& rest, const Vec3& point, const std::string& what);

}  // namespace palpate::identify
