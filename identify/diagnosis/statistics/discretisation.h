#pragma once

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {

/// How far the readings would be off by the model's mesh: what a finer one would alter in an explanation's equilibria
/// (N) [mm]. An action where that cannot be told keeps what `problem.discretisation` tells of it, else 0; empty where
/// the model cannot tell of any.
Eigen::VectorXd discretisation_error(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                                     const ForwardSolution& forward, int threads);

/// The same out of another problem of the same body; empty where it does not tell of all rows.
Eigen::VectorXd discretisation_of(const Problem& known, const Problem& problem);

}  // namespace palpate::identify
