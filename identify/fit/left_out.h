#pragma once

#include <vector>

#include "identify/fit/fit.h"
#include "identify/identify.h"

namespace palpate::identify {

/// How far a model is off under a probe that it was not fitted to: each probe in turn is forecast from all others.
///
/// A fit is nearest to the truth where it was fitted, and a coarse skeleton with many links much nearer than elsewhere:
/// what it leaves there is no measure of a forecast. Nobody has to fit again for each probe, though. Without the
/// probe's states the quadratic round the most probable v, theta = mean + C v, loses their J_p^T J_p and its slope
/// there is their -J_p^T d_p, so that the errors grow from d_p to
///   d_p + J_p (1 + A - J_p^T J_p)^-1 J_p^T d_p,    A = J^T J by v,
/// the predicted residual of [Allen 1974], by groups; exact where markers go linearly with v. Directions of which the
/// measurements tell next to nothing, those without an eigenpair, are left as they are, and so are the dents. Where the
/// spectrum is not whole, others are too, and the error is told from below.
/// @param probes of each state of the domain
/// @param fit with its final spectrum
ForecastError left_out_error(const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
                             const std::vector<int>& probes, int threads = 1);

}  // namespace palpate::identify
