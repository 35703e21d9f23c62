#pragma once

#include "identify/diagnosis/fit/refit.h"

namespace palpate::identify {

/// Largest whitened rms of N readings with a noise of 1 sigma: exceeded by chance with a probability that is told.
/// [chi^2]
double largest_noise(Eigen::Index readings, double probability);

/// The same of probes that are predicted from all others by a right explanation. Where they are few their errors hang
/// together, by the numbers that all of them tell of. By simulation of the fit's linear model: readings are drawn with
/// nuisances by their priors and with noise, and each probe is predicted from the others. The logarithm is nearly
/// normal, so that its mean and standard deviation tell the bound.
double largest_held_out(const Problem& problem, const Refit& fit, double probability);

}  // namespace palpate::identify
