#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::identify {

/// Markers on a body of tetrahedra: where they stand when its nodes are displaced by u (3n).
///
/// A marker on or in the body moves by the interpolated displacement. One that is rigidly attached to a surface point
/// a and stands off it by o moves by u(a) + (R - 1) o, R the rotation of the material at a: that of the polar
/// decomposition of F = 1 + grad u, or in small strain 1 + the skew part of grad u.
class MarkerFrames {
public:
    MarkerFrames(const mesh::VolumeMesh& body, const std::vector<Marker>& markers);

    Points positions(const Eigen::VectorXd& u, bool small_strain) const;                        // (m x 3) [mm]
    Eigen::SparseMatrix<double> derivative(const Eigen::VectorXd& u, bool small_strain) const;  // by u (3m x 3n)

private:
    Mat3 gradient(Eigen::Index marker, const Points& u) const;

    Points rest_;                                                  // (m x 3)
    Eigen::SparseMatrix<double, Eigen::RowMajor> N_;               // displacement at the markers' anchors (m x n)
    std::vector<Eigen::SparseMatrix<double, Eigen::RowMajor>> D_;  // its derivatives along x, y, z (m x n)
    Points offset_;                                                // from the anchor (m x 3); zero on the body
};

}  // namespace palpate::identify
