#pragma once

#include <vector>

#include "fem/large_deformation/body/unknowns.h"
#include "fem/large_deformation/elements/boundary_face.h"
#include "mesh/core/actuator.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// What a body of quadratic elements encloses: the volume V of each of its closed cavities, and their derivatives by
/// the nodes' displacements. A cavity is a part of the boundary, joined at edges, that encloses a negative volume by
/// its outward orientation. V is exact: on quadratic faces it is a sum of triple products of node positions.
class Cavities {
public:
    Cavities() = default;
    explicit Cavities(const mesh::VolumeMesh& mesh);

    bool empty() const { return walls_.empty(); }
    int count() const { return static_cast<int>(walls_.size()); }
    /// The one that an actuator means: that with a wall nearest to the point, or nearest in the mean to the vertices of
    /// the surface. @throws InvalidInput where there are none.
    int find(const mesh::PressureActuator& actuator) const;

    Eigen::VectorXd volumes(const Eigen::VectorXd& u) const;  // of each [mm^3]
    /// Adds sum_c factors_c dV_c/du to `sum` (3n).
    void add_gradient(const Eigen::VectorXd& u, const Eigen::VectorXd& factors, Eigen::VectorXd& sum) const;
    /// Adds sum_c factors_c d^2V_c/du^2.
    void add_hessian(const Eigen::VectorXd& u, const Eigen::VectorXd& factors, const Unknowns& unknowns,
                     LowerMatrix& K) const;

private:
    template <class Visit>
    void for_each_wall(const Eigen::VectorXd& factors, const Visit& visit) const;
    double distance(int cavity, const Vec3& point) const;  // of the nearest node of its walls

    Points nodes_;  // at rest, from somewhere amid the cavities, so that little is lost to rounding
    Vec3 origin_ = Vec3::Zero();
    std::vector<std::vector<BoundaryFace>> walls_;  // of each
};

}  // namespace palpate::fem
