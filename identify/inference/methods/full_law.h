#pragma once

#include "identify/inference/maximum/fit_map.h"
#include "identify/inference/particles/tempered_filter.h"

namespace palpate::identify {

/// Weighs particles of a surrogate's posterior by that under the law itself: each counts by the ratio of both
/// likelihoods at its own equilibria, which are sought from the surrogate's by the surrogate's tangent. Evidence and
/// independent draws follow; one without an equilibrium counts nothing.
/// @param surrogate domain.linearised at the fit
/// Returns the effective share of the particles.
double weigh_by_full_law(TemperedResult& particles, const PositionDomain& domain, const PositionDomain& surrogate,
                         const FitResult& fit, int threads);

}  // namespace palpate::identify
