#pragma once

#include <Eigen/Core>

namespace palpate::runtime {

/// What a tool does to the body: a force, and its moment about where the tool is.
struct ToolLoad {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   // [N]
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // [N mm]
};

}  // namespace palpate::runtime
