#pragma once

#include <utility>
#include <vector>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// Pairs of triangles that cross, touch or overlap beyond the corners that they share (by index), in rising order.
/// Triangles without area and twins (the same three corners) are left out. Exact.
std::vector<std::pair<int, int>> self_intersections(const Surface& surface);

/// Triangles whose corners lie exactly in a line, or are not three, in rising order.
std::vector<int> degenerate_triangles(const Surface& surface);

}  // namespace palpate::mesh
