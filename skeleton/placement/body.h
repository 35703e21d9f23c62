#pragma once

#include "skeleton/placement/cells.h"
#include "skeleton/placement/ground.h"

namespace palpate::skeleton {

/// Everything about a body that placing spheres works on.
struct Body {
    TetGraph graph;
    MedialAxis axis;
    Core core;
    Ground ground;
    Eigen::VectorXd free_volumes;  // zero where held (m) [mm^3]
    Eigen::VectorXd way;           // along the core from the support (m) [mm]
};

}  // namespace palpate::skeleton
