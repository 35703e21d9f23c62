#pragma once

#include "fem/large_deformation/body/loaded_body.h"
#include "fem/large_deformation/body_equilibrium.h"
#include "fem/large_deformation/solve/tangent_solver.h"

namespace palpate::fem {

/// Newton's method from `start`, else from rest, else with the load in 4 and then 16 steps; before or after rest, with
/// tools that come from off the body. A body that flows does so at once from what it was `before`, however many steps
/// the load is put on in. `guide`: the factored tangent of a state near `start`.
/// @throws SolverFailure with iterations and residual when all fail.
BodyEquilibrium find_equilibrium(const BodyShape& body, const EliminationOrder& order, const BodySetting& setting,
                                 const Eigen::VectorXd& f, const NewtonOptions& options, const Eigen::VectorXd* start,
                                 const MaterialState* before, const TangentSolver* guide = nullptr);

}  // namespace palpate::fem
