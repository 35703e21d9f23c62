#pragma once

#include <vector>

#include "mesh/volume_mesh.h"

namespace palpate::fem {

/// What each node of a quadratic body stands for (n). Corners of straight elements have a negative volume and no area,
/// which is right for loads that are spread evenly.
struct NodeIntegrals {
    Eigen::VectorXd volume;   // integral of N_i over the body [mm^3]
    Eigen::VectorXd area;     // integral of N_i over the boundary [mm^2]
    Eigen::VectorXd support;  // proportional to the integral of N_i^2 where held, else 0; sum 1 [-]
};

NodeIntegrals node_integrals(const mesh::VolumeMesh& mesh, const std::vector<char>& held);

}  // namespace palpate::fem
