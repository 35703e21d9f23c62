#pragma once

#include "identify/particles/tempered_filter.h"

namespace palpate::identify {

/// N particles of a Gaussian q near a posterior pi, as they are: for bodies so large that to look at pi for each of
/// them takes too long.
///
/// Right as far as pi is q. Where measurements are linear in theta and the prior is Gaussian it is, but for the
/// directions that q's spectrum leaves out: in these q is as wide as the prior, too wide by less than the spectrum's
/// least eigenvalue tells. So intervals err to the wide side, and a number counts as informed by what was found alone.
/// They stay unweighed, and the evidence is Laplace's, pi / q at the mean.
TemperedResult drawn_particles(const LogDensity& log_density, const GaussianProposal& proposal,
                               const TemperedOptions& options);

}  // namespace palpate::identify
