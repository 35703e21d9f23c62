#pragma once

#include <string>
#include <vector>

#include "identify/inference/priors/informative_prior.h"
#include "identify/inference/priors/log_normal_prior.h"
#include "identify/inference/problem/parameters.h"

namespace palpate::identify {

/// Replaces the prior of each parameter by that from specimens where that is narrower: few specimens that differ much
/// inform a link less than its neighbours do. Returns the names of these parameters.
std::vector<std::string> inform(LogNormalPrior& prior, const Parameters& parameters,
                                const std::vector<InformativePrior>& from_specimens);

}  // namespace palpate::identify
