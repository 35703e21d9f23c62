#pragma once

#include "identify/diagnosis/fit/refit_result.h"

namespace palpate::identify {

/// Gauss-Newton on half of d^T V^-1 d and the priors, d at the model's own equilibria with exact derivatives; the
/// nuisances are taken at the fit itself, in two rounds. Evidence by Laplace's approximation.
/// `start`: a fit nearby, whose configurations and nuisances serve to begin with.
/// @throws SolverFailure when no equilibria are found at the start, not even with a body six times as stiff.
Refit refit(const BodyModel& model, const Problem& problem, const Explanation& explanation, const RefitOptions& options,
            const Refit* start = nullptr);

/// Whitening with the numbers of a fit among the unknowns, about where it stands: what readings tell of each other.
Whitening with_numbers_unknown(const Refit& fit);

/// A fit as it stands, to readings that were corrected: nuisances and evidence anew, its numbers as they were.
Refit reassess(const BodyModel& model, const Problem& corrected, const RefitOptions& options, Refit fit);

/// Half of chi^2 and of the priors' squares: what a refit lowers.
double objective(const Refit& fit);

/// The same at an explanation's own equilibria, by the weights and nuisances of a fit nearby: what a refit from there
/// would begin with. One that yields, unlike that fit, has weights of its own, and what they alter of ln |V| / 2
/// counts. Infinite where there are no equilibria.
double objective_near(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                      const RefitOptions& options, const Refit& near);

/// Estimated final objective of a refit of the same effects under another law: its objective at the parameters of a
/// nearby fit, less the decrease of one Gauss-Newton step with that fit's Jacobian. Infinite where there are no
/// equilibria.
double promised_objective(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                          const RefitOptions& options, const Refit& near);

}  // namespace palpate::identify
