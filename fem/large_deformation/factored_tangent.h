#pragma once

#include "fem/large_deformation/unknowns.h"

namespace palpate::fem {

/// A body's tangent, factored over its unknowns.
class FactoredTangent final : public BodyTangent {
public:
    /// @throws SolverFailure when K is not positive definite.
    FactoredTangent(const EliminationOrder& order, const LowerMatrix& K);
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override;

private:
    int unknowns_;
    std::vector<int> number_;  // of each node, -1: held
    Cholesky cholesky_;
};

}  // namespace palpate::fem
