#pragma once

#include <vector>

#include "fem/large_deformation/body/element_regions.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// What each node of a quadratic body stands for (n). Corners of straight elements have a negative volume and no area,
/// which is right for loads that are spread evenly. A support's springs are equal, as where they are set node by node
/// in other solvers: what lies on the surface counts about twice as much as its volume, since what holds a body grips
/// it there.
struct NodeIntegrals {
    Eigen::VectorXd volume;   // integral of N_i over the body [mm^3]
    Eigen::VectorXd mass;     // the same, each region times its density as a share of the body's [mm^3]
    Eigen::VectorXd area;     // integral of N_i over the boundary [mm^2]
    Eigen::VectorXd support;  // the same for each node that is held, else 0; sum 1 [-]
};

NodeIntegrals node_integrals(const mesh::VolumeMesh& mesh, const std::vector<char>& held,
                             const ElementRegions& regions = {});

}  // namespace palpate::fem
