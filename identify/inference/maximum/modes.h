#pragma once

#include <cstdint>
#include <vector>

#include "identify/inference/maximum/fit_map.h"

namespace palpate::identify {

/// Maxima of the posterior, the highest first: `fit`, and what fits from eight more starts, drawn round the prior's
/// mean, find beside it. Nearly equal ones count once, those that are negligible next to the highest not at all. With
/// few data the posterior may be multimodal, for instance a body and its mirror image, and a fit started between two
/// modes ends at the saddle point. Only where it is cheap, so that the answer comes at once: up to 64 parameters, and
/// 4,000 spheres in all states; else `fit` alone. Adds to `evaluations` how often all equilibria were solved.
std::vector<FitResult> find_modes(const PositionDomain& domain, const LogNormalPrior& prior, FitResult fit,
                                  std::uint64_t seed, int threads, int& evaluations);

/// The same from these starts beside `fit`.
std::vector<FitResult> find_modes(const PositionDomain& domain, const LogNormalPrior& prior, FitResult fit,
                                  const std::vector<Eigen::VectorXd>& starts, int threads, int& evaluations);

}  // namespace palpate::identify
