#pragma once

#include <Eigen/Core>

namespace palpate {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// Positions or displacements, a row per point (n x 3) [mm].
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// Corner indices, a row per triangle (m x 3), counter-clockwise seen from outside.
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// Node indices, a row per element; 4 columns linear, 10 quadratic.
using Tetrahedra = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// Node indices of boundary faces, a row per face; 3 columns linear, 6 quadratic.
using Faces = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace palpate
