#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "fem/large_deformation/body_tangent.h"
#include "fem/linear_algebra/multigrid/chebyshev.h"

namespace palpate::fem {

/// Solves with a tangent J of a refined mesh by conjugate gradients, preconditioned by two grids: Chebyshev's smoother
/// on the fine one, the factored tangent of the coarse one for what is smooth. A handful of steps suffices, as the
/// coarse mesh lacks little but what lies between its nodes.
class TwoGrid {
public:
    using Interpolation = Eigen::SparseMatrix<double, Eigen::RowMajor>;

    /// `J`: of all fine nodes (3n' x 3n'); `held`: flags of these (n'); `interpolation`: coarse fields at them
    /// (n' x n). The last two arguments are kept by reference.
    /// @throws SolverFailure where a block of J's diagonal is not positive definite.
    TwoGrid(const Eigen::SparseMatrix<double>& J, const std::vector<char>& held, const Interpolation& interpolation,
            const BodyTangent& coarse);

    /// J^-1 r (3n'), zero at held nodes, with the error's energy norm down to about `tolerance` of the answer's. Where
    /// J is not positive definite it ends at the first direction of negative curvature.
    Eigen::VectorXd solve(const Eigen::VectorXd& r, double tolerance) const;
    /// About J^-1 r, by the preconditioner alone.
    Eigen::VectorXd estimate(const Eigen::VectorXd& r) const;

private:
    MultiVector gather(const Eigen::VectorXd& at_all) const;
    Eigen::VectorXd scatter(const MultiVector& x) const;
    MultiVector precondition(const MultiVector& r) const;
    MultiVector correct_on_coarse_grid(const MultiVector& residual) const;

    std::vector<int> free_;  // fine nodes that may move
    BlockMatrix<3, 3> J_;    // of these
    BlockMatrix<3, 3, float> rounded_;
    Chebyshev<3> smoother_;
    const Interpolation& interpolation_;
    const BodyTangent& coarse_;
};

}  // namespace palpate::fem
