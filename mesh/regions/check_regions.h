#pragma once

#include <string>
#include <vector>

#include "mesh/core/material_region.h"

namespace palpate::mesh {

/// Triangles of one surface that cross or touch those of another: a place of each pair [mm].
std::vector<Vec3> meeting_places(const Surface& one, const Surface& other);

/// Regions have to be sound surfaces, large enough to matter, inside the body and clear of its surface, disjoint or
/// nested. @param where begins a message: the file. @throws InvalidInput naming the regions, and where they meet.
void check_regions(const std::vector<MaterialRegion>& regions, const Surface& body, const std::string& where);

}  // namespace palpate::mesh
