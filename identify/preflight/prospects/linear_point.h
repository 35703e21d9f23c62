#pragma once

#include <memory>
#include <vector>

#include "identify/diagnosis/likelihood/nuisances.h"
#include "identify/diagnosis/likelihood/whitening.h"
#include "identify/effects/effect.h"

namespace palpate::identify {

/// A body about a guess of its stiffness, linear in everything that is unknown: before any fit.
struct LinearPoint {
    Explanation explanation;  // without effects
    ForwardSolution forward;
    Eigen::MatrixXd columns;  // d readings / d stiffness numbers, over sigma (N x P)
    Eigen::VectorXd prior_sd;
    Nuisances nuisances;
    Whitening rig;  // V of noise and of what nobody can know about contacts and clamps
    Whitening all;  // the same with the stiffness numbers unknown as well
};

/// Linearises a model's readings at an explanation without effects. One factorisation for all actions in small strain.
/// @param mesh_error share of what is read in a state that the model may be off by, beside its noise: no sensor is
/// finer than the mesh
/// @param known the same explanation in a problem whose actions are this one's first: where equilibria are sought from
/// @throws SolverFailure where an action has no equilibrium.
LinearPoint linearise(const BodyModel& model, const Problem& problem, const Explanation& explanation, double mesh_error,
                      int threads, const LinearPoint* known = nullptr);

/// What an effect does to the readings where it is weak.
struct EffectSignature {
    std::shared_ptr<const EffectHypothesis> effect;
    ScreenColumns columns;  // over sigma; no alternatives: it cannot show in the problem
};

/// Signatures of effects as the diagnosis screens them, in their order.
std::vector<EffectSignature> signatures_at(const BodyModel& model, const Problem& problem, const LinearPoint& point,
                                           const std::vector<std::shared_ptr<const EffectHypothesis>>& effects,
                                           int threads);

}  // namespace palpate::identify
