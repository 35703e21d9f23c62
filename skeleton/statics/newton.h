#pragma once

#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/skeleton_system.h"

namespace palpate::skeleton {

/// Brings `at.state` to a stable equilibrium, adding to `at.iterations`; the tangent there is left factored.
/// False when it was not reached in options.iterations steps: `at` is the last state then.
///
/// Newton's method on the potential. Where the tangent is not positive definite it is shifted until it is, so that
/// each step leads downhill; a step is shortened to the step limit, then until the potential falls.
/// [Nocedal & Wright 2006, algorithms 3.1 and 3.3]
/// @throws SolverFailure naming the sphere that the equilibrium leaves free to move.
bool newton(SkeletonSystem& system, const Eigen::VectorXd& k, const Load& load, const EquilibriumOptions& options,
            Equilibrium& at);

}  // namespace palpate::skeleton
