#pragma once

#include <string>

#include "identify/diagnosis/search/baselines.h"

namespace palpate::identify {

/// Takes the error of the mesh off a problem's readings, as it is in an explanation's equilibria; how much that changes
/// the readings, rms over sigma.
double correct_for_mesh(const BodyModel& model, Problem& problem, const Explanation& explanation,
                        const ForwardSolution& forward, int threads);

/// The same for a problem and its baselines, which are fitted anew.
///
/// A coarse mesh bends the numbers that are fitted with it: one that keeps its volume badly looks compressible, or not
/// at all. So the error is first computed with those that are believed before the measurements, and then where the fit
/// to what it leaves stands, until it hardly changes next to what that fit leaves.
void correct_baselines_for_mesh(const BodyModel& model, Problem& problem, Baselines& baselines, int threads);

/// Does an error of the mesh, or a change of it, show next to what a fit leaves, which is noise at least?
/// `change` (N) [mm].
bool shows_next_to(const Refit& fit, const Problem& problem, const Eigen::VectorXd& change);

/// What was taken off, where it would have shown; empty: it would not.
std::string note_of_correction(const Problem& problem);

}  // namespace palpate::identify
