#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "skeleton/model/state.h"

namespace palpate::skeleton {

/// Positions of attached points (m x 3) [mm], as far out as the model says that they have grown.
Points observe(const Model& model, const State& state, const std::vector<Attachment>& points);

/// P = d observe / d step (3m x 6N).
Eigen::SparseMatrix<double> observation_jacobian(const Model& model, const State& state,
                                                 const std::vector<Attachment>& points);

}  // namespace palpate::skeleton
