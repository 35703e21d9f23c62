#pragma once

#include <vector>

#include "mesh/types.h"

namespace palpate::mesh {

/// Indices of `count` of the points that lie far from each other: each next one is the furthest from those before,
/// ties by lower index. `first` starts. All of them when count exceeds their number.
std::vector<int> farthest_points(const Points& points, int count, int first = 0);

/// The nearest of the seeds to a point, as an index into `seeds`, which are indices of points; ties by lower index.
Eigen::Index nearest_seed(const Points& points, const std::vector<int>& seeds, Eigen::Index point);

}  // namespace palpate::mesh
