#pragma once

#include <vector>

#include "mesh/core/region.h"

namespace palpate::mesh {

/// Those of the regions whose border is known: all but the PointsRegions.
std::vector<Region> with_borders(const std::vector<Region>& regions);

/// The nearest point of regions with borders [mm]. @pre with_borders(regions) is not empty.
Vec3 closest_within(const std::vector<Region>& regions, const Vec3& point);

}  // namespace palpate::mesh
