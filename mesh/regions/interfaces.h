#pragma once

#include <vector>

#include "mesh/core/material_region.h"

namespace palpate::mesh {

/// The surfaces of regions, in their order.
struct Interfaces {
    std::vector<Surface> surfaces;
    std::vector<char> is_followed;  // elements can end there

    std::vector<Surface> followed() const;
};

/// The surfaces of regions in triangles that elements can follow, as large as the regions: edges no longer than `edge`
/// [mm], shorter where a region is small or curved, or its surface close to another one. Those that touch the surface
/// of the body, or of a larger region that is followed, stay as they are, and are not followed.
/// @param body its surface, remeshed. @pre check_regions. @throws SolverFailure where surfaces are too close.
Interfaces remesh_interfaces(const std::vector<MaterialRegion>& regions, const Surface& body, double edge);

}  // namespace palpate::mesh
