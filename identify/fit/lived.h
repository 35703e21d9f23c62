#pragma once

#include "identify/set/readings.h"
#include "skeleton/equilibrium.h"

namespace palpate::identify {

/// Does the material remember? Then states are played in their order.
bool remembers(const std::vector<StateReadings>& states);

/// How far a model's links had flowed before a state: after what it went through since the last state that was read,
/// whose equilibrium is among those found `so_far`, in the states' order. Empty where nothing yields.
/// @throws SolverFailure when a state in between has no equilibrium.
skeleton::FibreStates flowed_before(const skeleton::Model& model, skeleton::StaticsSolver& solver,
                                    const Eigen::VectorXd& k, const std::vector<StateReadings>& states, int state,
                                    const std::vector<skeleton::Equilibrium>& so_far);

}  // namespace palpate::identify
