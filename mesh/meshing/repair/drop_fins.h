#pragma once

#include <vector>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// Without fins: open sheets that stand on edges where more than two triangles meet, of 1 % of the area at most in all.
/// `dropped` gets the vertices that only they had.
Surface drop_fins(const Surface& surface, std::vector<Vec3>& dropped);

}  // namespace palpate::mesh
