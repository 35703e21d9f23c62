#pragma once

#include <vector>

#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

inline constexpr int element_nodes = 10;  // quadratic tetrahedra
inline constexpr int element_points = 4;  // of the quadrature rule, exact to degree 2

/// Where an element's quadrature points are, a row each (points x 3) [mm].
using PointPositions = Eigen::Matrix<double, element_points, 3, Eigen::RowMajor>;

/// A quadratic element at rest, straight or curved: all that integrals over it need.
struct ElementShape {
    /// dN_i/dX_a at quadrature point q is entry (3 q + a, i) [1/mm].
    Eigen::Matrix<double, 3 * element_points, element_nodes, Eigen::RowMajor> dN;
    Eigen::Vector4d w;  // volume that each quadrature point stands for [mm^3]

    auto gradients(int q) const { return dN.middleRows<3>(3 * q); }  // (3 x nodes)
};

/// @throws InvalidInput when elements are not quadratic, or naming one that is turned inside out.
std::vector<ElementShape> element_shapes(const mesh::VolumeMesh& mesh);

}  // namespace palpate::fem
