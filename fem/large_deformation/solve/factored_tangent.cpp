#include "fem/large_deformation/solve/factored_tangent.h"

#include <cassert>

#include "mesh/errors.h"

namespace palpate::fem {

FactoredTangent::FactoredTangent(const EliminationOrder& order, const LowerMatrix& K)
    : structure_(order.supernodes),
      unknowns_(order.unknowns.size()),
      number_(order.unknowns.number()),
      solver_(make_tangent_solver(order, Accuracy::answers)) {
    if (!solver_->take(K)) {
        throw SolverFailure(
            "The body's tangent is not positive definite here: these displacements are no stable equilibrium. Take "
            "those of an equilibrium, or a smaller load.");
    }
}

Eigen::MatrixXd FactoredTangent::solve(const Eigen::MatrixXd& B) const {
    assert(B.rows() == static_cast<Eigen::Index>(3 * number_.size()));
    constexpr Eigen::Index together = 64;  // right-hand sides
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(B.rows(), B.cols());
    const auto for_unknowns = [&](auto&& visit) {
        for (std::size_t i = 0; i < number_.size(); ++i) {
            if (number_[i] >= 0) visit(static_cast<Eigen::Index>(3 * i), std::int64_t(3) * number_[i]);
        }
    };
    for (Eigen::Index first = 0; first < B.cols(); first += together) {
        const Eigen::Index count = std::min(together, B.cols() - first);
        MultiVector X(unknowns_, count);
        for_unknowns([&](auto node, auto row) { X.middleRows<3>(row) = B.block(node, first, 3, count); });
        solver_->solve(X);
        for_unknowns([&](auto node, auto row) { result.block(node, first, 3, count) = X.middleRows<3>(row); });
    }
    return result;
}

}  // namespace palpate::fem
