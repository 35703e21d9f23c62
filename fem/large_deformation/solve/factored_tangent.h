#pragma once

#include "fem/large_deformation/body/unknowns.h"
#include "fem/large_deformation/body_tangent.h"
#include "fem/large_deformation/solve/tangent_solver.h"

namespace palpate::fem {

/// A body's tangent, factored over its unknowns, or ready for iterations.
class FactoredTangent final : public BodyTangent {
public:
    /// @throws SolverFailure when K is not positive definite.
    FactoredTangent(const EliminationOrder& order, const LowerMatrix& K);
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override;
    double gigabytes() const override { return solver_->gigabytes(); }

    /// Factored over these unknowns, in this order?
    bool is_in(const EliminationOrder& order) const { return structure_ && structure_ == order.supernodes; }
    const TangentSolver& solver() const { return *solver_; }

private:
    std::shared_ptr<const Supernodes> structure_;
    int unknowns_;
    std::vector<int> number_;  // of each node, -1: held
    std::unique_ptr<TangentSolver> solver_;
};

}  // namespace palpate::fem
