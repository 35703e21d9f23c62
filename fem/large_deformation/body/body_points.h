#pragma once

#include <vector>

#include "fem/large_deformation/body/unknowns.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// The element that carries a point, and the shape functions there: it moves by sum_i N_i u_i.
struct Carrier {
    int element = 0;
    Eigen::Matrix<double, element_nodes, 1> N = Eigen::Matrix<double, element_nodes, 1>::Zero();
};

/// Points that a body carries.
struct BodyPoints {
    Points rest;              // (p x 3) [mm]
    Eigen::VectorXd weights;  // (p)
    std::vector<Carrier> carriers;

    Vec3 displacement(const mesh::VolumeMesh& mesh, std::size_t k, const Eigen::VectorXd& u) const;
};

/// Points all over the boundary, three to a face, which stand for its area [mm^2].
BodyPoints boundary_points(const mesh::VolumeMesh& mesh);
/// The nodes, each of weight 1.
BodyPoints node_points(const mesh::VolumeMesh& mesh);

/// Adds H N_i N_j to an element's tangent.
void add_outer(const Mat3& H, const Carrier& carrier, ElementTangent& K);

}  // namespace palpate::fem
