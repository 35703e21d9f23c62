#pragma once

#include "identify/set/readings.h"
#include "skeleton/equilibrium.h"

namespace palpate::identify {

/// Does the material remember? Then states are played in their order.
bool remembers(const std::vector<StateReadings>& states);

/// What a body had gone through before a state.
struct Lived {
    std::vector<skeleton::Equilibrium> unread;  // since the last state that was read, in their order
    skeleton::FibreStates flowed;               // how far its links had flowed; empty where nothing yields
    bool whole = true;                          // under the loads that it had borne, and not under less
};

/// Of a model whose equilibria in the states that were read are among those found `so_far`, in the states' order.
/// `near`: where the unread ones stood at neighbouring stiffnesses.
/// @throws SolverFailure when an unread state has no equilibrium.
Lived lived_before(const skeleton::Model& model, skeleton::StaticsSolver& solver, const Eigen::VectorXd& k,
                   const std::vector<StateReadings>& states, int state,
                   const std::vector<skeleton::Equilibrium>& so_far,
                   const std::vector<skeleton::Equilibrium>* near = nullptr);
/// The same, with the loads of unread states lowered to what the model bears of them.
/// @throws SolverFailure as solve_as_far_as_it_bears.
Lived lived_as_far_as_it_bears(const skeleton::Model& model, skeleton::StaticsSolver& solver, const Eigen::VectorXd& k,
                               const std::vector<StateReadings>& states, int state,
                               const std::vector<skeleton::Equilibrium>& so_far);

}  // namespace palpate::identify
