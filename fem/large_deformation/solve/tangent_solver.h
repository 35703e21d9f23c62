#pragma once

#include <memory>

#include "fem/large_deformation/body/unknowns.h"

namespace palpate::fem {

/// Solves with a tangent over some unknowns.
class TangentSolver {
public:
    virtual ~TangentSolver() = default;
    /// Takes K in place of the tangent before; false, and nothing to solve with, where K is found not to be positive
    /// definite.
    virtual bool take(const LowerMatrix& K) = 0;
    /// X <- K^-1 X. Safe from several threads.
    virtual void solve(MultiVector& X) const = 0;
    virtual double gigabytes() const = 0;
};

/// How well iterations solve where there is no factor.
enum class Accuracy {
    steps,   // for Newton steps: to a thousandth, and where K is not positive definite, a direction of descent
    answers  // to 1e-11 in the energy norm
};

/// By a factor where the unknowns have an order for one, else by conjugate gradients with multigrid or PETSc.
/// @throws SolverFailure when memory does not suffice.
std::unique_ptr<TangentSolver> make_tangent_solver(const EliminationOrder& order, Accuracy accuracy);

}  // namespace palpate::fem
