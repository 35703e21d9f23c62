#pragma once

#include "identify/diagnosis/fit/refit.h"

namespace palpate::identify {

/// How many times as far off on held-out probes an explanation with one more effect may be by chance.
///
/// A design choice. Numbers that the left-out probe alone tells, as its gain, are unknown there, and others are known
/// less well than without the effect: a right explanation errs as much as without it, or a little more. Errors with and
/// without it are of the same readings, and hang together by more than any number of readings tells; rms errors of N
/// readings that are independent would differ by 1/sqrt(N) of their size, a tenth for N = 100. Less than 1.1 refuses
/// right effects, more lets effects pass that overfit single probes.
inline constexpr double held_out_tolerance = 1.1;

/// Largest whitened rms, exceeded by chance with a probability that is told, of probes that are predicted from all
/// others by a right explanation. Where they are few their errors hang
/// together, by the numbers that all of them tell of. By simulation of the fit's linear model: readings are drawn with
/// nuisances by their priors and with noise, and each probe is predicted from the others. The logarithm is nearly
/// normal, so that its mean and standard deviation tell the bound.
double largest_held_out(const Problem& problem, const Refit& fit, double probability);

}  // namespace palpate::identify
