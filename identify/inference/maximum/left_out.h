#pragma once

#include <vector>

#include "identify/inference/maximum/fit_map.h"
#include "identify/inference/maximum/forecast_error.h"

namespace palpate::identify {

/// Leave-one-probe-out prediction error of a model.
///
/// A fit is nearest to the truth where it was fitted, and a coarse skeleton with many links much nearer than elsewhere:
/// what it leaves there is no measure of a forecast. Nobody has to fit again for each probe, though. Without the
/// probe's states the quadratic round the most probable v, theta = mean + C v, loses their J_p^T J_p and its slope
/// there is their -J_p^T d_p, so that the errors grow from d_p to
///   d_p + J_p (1 + A - J_p^T J_p)^-1 J_p^T d_p,    A = J^T J by v,
/// the predicted residual of [Allen 1974], by groups; exact where markers go linearly with v. Unobserved directions,
/// those without an eigenpair, are kept fixed, and so are the indentation amplitudes. With a truncated spectrum further
/// directions are fixed, and the error is underestimated.
/// @param probes of each state of the domain
/// @param fit with its final spectrum
ForecastError leave_one_out_error(const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
                                  const std::vector<int>& probes, int threads = 1);

}  // namespace palpate::identify
