#pragma once

#include "identify/inference/particles/perturbed.h"
#include "identify/inference/particles/tempered_filter.h"

namespace palpate::identify {

/// N unweighted samples of a Gaussian approximation q of the posterior pi, for models so large that evaluating pi for
/// each sample is too expensive.
///
/// Right as far as pi is q. Where measurements are linear in theta and the prior is Gaussian it is, but for the
/// directions that q's spectrum leaves out: in these q is as wide as the prior, too wide by less than the spectrum's
/// least eigenvalue tells. So intervals are conservative, and a parameter counts as informed only by the eigenpairs
/// found. They stay unweighed, and the evidence is Laplace's, pi / q at the mean.
TemperedResult laplace_particles(const LogDensity& log_density, const GaussianProposal& proposal,
                                 const TemperedOptions& options);

/// The same where the measurements tell about more directions than a spectrum has room for: round `mean`, by
/// perturbed steps of the fit. As many of these are made as 2e5 numbers hold, and no fewer than 24; where more
/// particles are wanted, each is a mixture of all of them with weights of squares that add up to 1, so that each is as
/// wide as the posterior, and together they tell its covariance as well as the 24 do: an sd to 14 %. The evidence
/// counts the spectrum's directions alone: it is too large.
TemperedResult perturbed_particles(const LogDensity& log_density, const Eigen::VectorXd& mean,
                                   const PerturbedSteps& steps, const GaussianProposal& proposal,
                                   const TemperedOptions& options);

/// How many perturbed steps to make, of so many numbers.
int independent_draws(int parameters, int particles);

}  // namespace palpate::identify
