#pragma once

#include <string>
#include <vector>

#include "mesh/core/material_region.h"

namespace palpate::mesh {

/// Triangles of one surface that cross or touch those of another: a place of each pair [mm].
std::vector<Vec3> meeting_places(const Surface& one, const Surface& other);

/// Is one closed surface within another, rather than beside it?
bool lies_within(const Surface& one, const Surface& other);

/// Regions have to be sound surfaces, large enough to matter and inside the body; side by side, apart or nested. They
/// may touch the body's surface and each other. @param where begins a message: the file. @throws InvalidInput naming
/// the regions, and where they overlap.
void check_regions(const std::vector<MaterialRegion>& regions, const Surface& body, const std::string& where);

}  // namespace palpate::mesh
