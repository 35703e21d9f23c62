#pragma once

#include <vector>

#include "mesh/types.h"

namespace palpate::fem {

/// Points in the order of a curve that fills their box [Morton 1966]: what is near in space is near in memory, whatever
/// order a mesh came in. The places of the first, second, ... point in `points` (n x 3).
std::vector<int> morton_order(const Points& points);

}  // namespace palpate::fem
