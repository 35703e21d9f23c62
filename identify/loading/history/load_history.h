#pragma once

#include "identify/loading/readings.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::identify {

/// Is the material history-dependent? Then states are solved in their order.
bool is_history_dependent(const std::vector<StateReadings>& states);

/// Load history of a body before a state.
struct LoadHistory {
    std::vector<skeleton::Equilibrium> unmeasured;  // since the last state that was read, in their order
    skeleton::FibreStates flowed;                   // how far its links had flowed; empty where nothing yields
    bool is_full_load = true;                       // false: some loads of the history were reduced
};

/// Of a model whose equilibria in the states that were read are among those found `so_far`, in the states' order.
/// `near`: where the unmeasured ones stood at neighbouring stiffnesses.
/// @throws SolverFailure when an unmeasured state has no equilibrium.
LoadHistory history_before(const skeleton::Model& model, skeleton::StaticsSolver& solver, const Eigen::VectorXd& k,
                           const std::vector<StateReadings>& states, int state,
                           const std::vector<skeleton::Equilibrium>& so_far,
                           const std::vector<skeleton::Equilibrium>* near = nullptr);
/// The same, with the loads of unmeasured states lowered to what the model bears of them.
/// @throws SolverFailure as solve_with_reduced_load.
LoadHistory reduced_load_history_before(const skeleton::Model& model, skeleton::StaticsSolver& solver,
                                        const Eigen::VectorXd& k, const std::vector<StateReadings>& states, int state,
                                        const std::vector<skeleton::Equilibrium>& so_far);

}  // namespace palpate::identify
