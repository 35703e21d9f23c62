#pragma once

#include "skeleton/construction/placement/support_interface.h"
#include "skeleton/construction/shape/cells.h"

namespace palpate::skeleton {

/// Everything about a body that placing spheres works on.
struct PlacementBody {
    TetGraph graph;
    MedialAxis axis;
    Core core;
    SupportInterface interface;
    Eigen::VectorXd free_volumes;  // zero where held (m) [mm^3]
    Eigen::VectorXd path_length;   // along the core from the support (m) [mm]
};

}  // namespace palpate::skeleton
