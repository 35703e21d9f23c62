#pragma once

#include "identify/diagnosis/likelihood/nuisances.h"

namespace palpate::identify {

/// Weights W (N): 1 far from contacts; below it near one, where a reading depends on how exactly the contact is made:
///   sigma^2 -> sigma^2 + (kappa U min(1, (1.2 r / d)^2) (1 + p/E))^2, U = F (1 - nu^2) / (2 E r), p = F / (pi r^2),
/// d the reading's distance from the contact at rest, kappa the `dent`; the last factor for laws of large deformation.
/// What a tool touches is a contact as well, and so is each point of the skin that a wall presses (`wall_dent`).
/// Nor does a mesh end a support more exactly than its pieces are long: for a marker that moves by u against the
/// support, d from it,
///   sigma^2 -> sigma^2 + (ragged u exp(-(d/l)^2))^2, l twice the mean distance of the pieces that its border cuts.
/// Where the material yields, a share of the modelled displacement comes on top: what flows keeps and adds up the
/// errors of its mesh. It keeps dents, too: contacts of earlier stages count as well, and U is the larger where the
/// pressure is beyond yield.
Eigen::VectorXd reading_weights(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                                const ForwardSolution& forward, const NuisanceOptions& options = {});

}  // namespace palpate::identify
