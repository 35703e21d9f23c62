#pragma once

#include <Eigen/SparseCore>
#include <cstdint>

namespace palpate::fem {

/// The lower half of a symmetric matrix.
using LowerMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

}  // namespace palpate::fem
