#pragma once

#include "identify/diagnosis/fit/priors/fit_priors.h"
#include "identify/diagnosis/fit/refit_result.h"

namespace palpate::identify {

/// Covariance of a fit's numbers (p x p) beside that of the noise: as the probes disagree, and by what finer meshes
/// leave of the mesh's error.
Eigen::MatrixXd scatter_of(const Problem& problem, const FitPriors& priors, const Refit& at);

}  // namespace palpate::identify
