#pragma once

#include <array>
#include <vector>

#include "fem/effects/surface/facet.h"
#include "fem/large_deformation/body/unknowns.h"
#include "fem/large_deformation/elements/boundary_face.h"

namespace palpate::fem {

/// The boundary of a body of quadratic elements, as energies of its area feel it, and their derivatives by the nodes'
/// displacements.
class Skin {
public:
    explicit Skin(const mesh::VolumeMesh& mesh);

    /// Pi [N mm]; adds `factor` dPi/du to `sum` (3n). `linear`, here and below: by the linear law, which takes it as it
    /// is at rest, to second order.
    double add_gradient(const SurfaceEnergies& effects, bool linear, const Eigen::VectorXd& u, double factor,
                        Eigen::VectorXd& sum) const;
    /// Adds `factor` d^2 Pi/du^2.
    void add_hessian(const SurfaceEnergies& effects, bool linear, const Eigen::VectorXd& u, double factor,
                     const Unknowns& unknowns, LowerMatrix& K) const;

private:
    using FaceHessian = Eigen::Matrix<double, 18, 18>;
    struct FaceTerms {
        double energy = 0;
        FaceNodes gradient = FaceNodes::Zero();
    };
    FaceTerms terms(const SurfaceEnergies& effects, std::size_t face, const FaceNodes& x) const;
    FaceHessian hessian(const SurfaceEnergies& effects, std::size_t face, const FaceNodes& x) const;

    Points nodes_;  // at rest
    std::vector<BoundaryFace> faces_;
    std::vector<std::array<FacetPoint<6>, 7>> points_;  // of each face
};

}  // namespace palpate::fem
