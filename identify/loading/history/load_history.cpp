#include "identify/loading/history/load_history.h"

#include <algorithm>

#include "identify/loading/reduced_load.h"
#include "mesh/errors.h"

namespace palpate::identify {

bool is_history_dependent(const std::vector<StateReadings>& states) {
    return std::ranges::any_of(states, [](const StateReadings& s) { return s.before >= 0 || !s.unmeasured.empty(); });
}

namespace {

/// As known from the measured states.
LoadHistory history_in_measured_states(const skeleton::Model& model, const StateReadings& own,
                                       const std::vector<skeleton::Equilibrium>& so_far) {
    LoadHistory history;
    if (own.before < 0) return history;
    if (so_far[own.before].step.size() == 0) throw SolverFailure("a state before had no equilibrium");
    history.flowed = skeleton::flowed(model, so_far[own.before]);
    return history;
}

}  // namespace

LoadHistory history_before(const skeleton::Model& model, skeleton::StaticsSolver& solver, const Eigen::VectorXd& k,
                           const std::vector<StateReadings>& states, int state,
                           const std::vector<skeleton::Equilibrium>& so_far,
                           const std::vector<skeleton::Equilibrium>* near) {
    LoadHistory history = history_in_measured_states(model, states[state], so_far);
    for (const skeleton::Load& load : states[state].unmeasured) {
        const skeleton::State* start = near ? &(*near)[history.unmeasured.size()].state : nullptr;
        history.unmeasured.push_back(solver.solve(k, load, {}, start, history.flowed));
        history.flowed = skeleton::flowed(model, history.unmeasured.back());
    }
    return history;
}

LoadHistory reduced_load_history_before(const skeleton::Model& model, skeleton::StaticsSolver& solver,
                                        const Eigen::VectorXd& k, const std::vector<StateReadings>& states, int state,
                                        const std::vector<skeleton::Equilibrium>& so_far) {
    LoadHistory history = history_in_measured_states(model, states[state], so_far);
    for (const skeleton::Load& load : states[state].unmeasured) {
        ReducedLoadEquilibrium reduced = solve_with_reduced_load(solver, k, load, history.flowed);
        history.is_full_load = history.is_full_load && reduced.is_full_load;
        history.unmeasured.push_back(std::move(reduced.equilibrium));
        history.flowed = skeleton::flowed(model, history.unmeasured.back());
    }
    return history;
}

}  // namespace palpate::identify
