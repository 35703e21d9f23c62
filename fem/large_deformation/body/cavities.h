#pragma once

#include <vector>

#include "fem/large_deformation/body/unknowns.h"
#include "fem/large_deformation/elements/boundary_face.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// What a body of quadratic elements encloses: the volume V of its closed cavities, and its derivatives by the nodes'
/// displacements. A cavity is a part of the boundary, joined at edges, that encloses a negative volume by its outward
/// orientation. V is exact: on quadratic faces it is a sum of triple products of node positions.
class Cavities {
public:
    Cavities() = default;
    explicit Cavities(const mesh::VolumeMesh& mesh);

    bool empty() const { return faces_.empty(); }
    double volume(const Eigen::VectorXd& u) const;  // [mm^3]
    /// Adds `factor` dV/du to `sum` (3n).
    void add_gradient(const Eigen::VectorXd& u, double factor, Eigen::VectorXd& sum) const;
    /// Adds `factor` d^2V/du^2.
    void add_hessian(const Eigen::VectorXd& u, double factor, const Unknowns& unknowns, LowerMatrix& K) const;

private:
    Points nodes_;  // at rest, from somewhere amid the cavities, so that little is lost to rounding
    std::vector<BoundaryFace> faces_;
};

}  // namespace palpate::fem
