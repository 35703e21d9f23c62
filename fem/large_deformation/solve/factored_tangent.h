#pragma once

#include "fem/large_deformation/body/unknowns.h"
#include "fem/large_deformation/body_tangent.h"

namespace palpate::fem {

/// A body's tangent, factored over its unknowns.
class FactoredTangent final : public BodyTangent {
public:
    /// @throws SolverFailure when K is not positive definite.
    FactoredTangent(const EliminationOrder& order, const LowerMatrix& K);
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override;
    double gigabytes() const override { return 8e-9 * cholesky_.entries(); }

    /// Over these unknowns, in this order?
    bool is_in(const EliminationOrder& order) const { return structure_ == order.supernodes; }
    const Cholesky& factor() const { return cholesky_; }

private:
    std::shared_ptr<const Supernodes> structure_;
    int unknowns_;
    std::vector<int> number_;  // of each node, -1: held
    Cholesky cholesky_;
};

}  // namespace palpate::fem
