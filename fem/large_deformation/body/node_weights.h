#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::fem {

/// Points that an effect acts on: nodes of the mesh, and their weights.
struct NodeWeights {
    std::vector<int> nodes;
    Eigen::VectorXd weights;
};

}  // namespace palpate::fem
