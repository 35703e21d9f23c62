#pragma once

#include <vector>

#include "mesh/core/material_region.h"

namespace palpate::mesh {

/// The surfaces of regions in triangles that elements can follow, as large as the regions, in their order: edges no
/// longer than `edge` [mm], shorter where a region is small or curved, or its surface close to another one.
/// @param body its surface, remeshed. @pre check_regions. @throws SolverFailure where surfaces are too close.
std::vector<Surface> remesh_interfaces(const std::vector<MaterialRegion>& regions, const Surface& body, double edge);

}  // namespace palpate::mesh
