#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::identify {

/// The column of each row that makes the least sum of costs, each column given once: the Hungarian method
/// [Kuhn 1955, Munkres 1957] by shortest augmenting paths, O(n^3). @pre as many columns as rows at least; finite costs
std::vector<int> least_assignment(const Eigen::MatrixXd& cost);

}  // namespace palpate::identify
