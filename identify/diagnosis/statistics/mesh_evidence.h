#pragma once

#include "identify/diagnosis/diagnosis.h"

namespace palpate::identify {

/// ln Bayes factor that an error of the mesh lends to what an explanation adds, exceeded with a probability of
/// exp(-`rarity`) at most.
///
/// The error m that is left after the correction is like the correction d, which halved edges tell, but differs from
/// probe to probe: m = sum a_p d_p, with a_p independent and normal of standard deviation `share`. To the added numbers
/// of columns S with priors tau, next to all other numbers and the nuisances (V), it lends
///   a^T Q a / 2,   Q = D^T V^-1 S (S^T V^-1 S + tau^-2)^-1 S^T V^-1 D,
/// a weighted sum of squares, whose tail is bounded by tr Q + 2 |Q| sqrt(x) + 2 lambda_max x [Laurent & Massart,
/// Adaptive estimation of a quadratic functional by model selection, Ann. Statist. 28, 2000, lemma 1].
double evidence_of_mesh_error(const Problem& problem, const FittedExplanation& explained, double share, double rarity);

}  // namespace palpate::identify
