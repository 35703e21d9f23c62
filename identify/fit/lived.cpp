#include "identify/fit/lived.h"

#include <algorithm>

#include "identify/fit/borne.h"
#include "mesh/errors.h"

namespace palpate::identify {

bool remembers(const std::vector<StateReadings>& states) {
    return std::ranges::any_of(states, [](const StateReadings& s) { return s.before >= 0 || !s.unread.empty(); });
}

namespace {

/// As far as the states that were read tell.
Lived lived_in_read_states(const skeleton::Model& model, const StateReadings& own,
                           const std::vector<skeleton::Equilibrium>& so_far) {
    Lived lived;
    if (own.before < 0) return lived;
    if (so_far[own.before].step.size() == 0) throw SolverFailure("a state before had no equilibrium");
    lived.flowed = skeleton::flowed(model, so_far[own.before]);
    return lived;
}

}  // namespace

Lived lived_before(const skeleton::Model& model, skeleton::StaticsSolver& solver, const Eigen::VectorXd& k,
                   const std::vector<StateReadings>& states, int state,
                   const std::vector<skeleton::Equilibrium>& so_far, const std::vector<skeleton::Equilibrium>* near) {
    Lived lived = lived_in_read_states(model, states[state], so_far);
    for (const skeleton::Load& load : states[state].unread) {
        const skeleton::State* start = near ? &(*near)[lived.unread.size()].state : nullptr;
        lived.unread.push_back(solver.solve(k, load, {}, start, lived.flowed));
        lived.flowed = skeleton::flowed(model, lived.unread.back());
    }
    return lived;
}

Lived lived_as_far_as_it_bears(const skeleton::Model& model, skeleton::StaticsSolver& solver, const Eigen::VectorXd& k,
                               const std::vector<StateReadings>& states, int state,
                               const std::vector<skeleton::Equilibrium>& so_far) {
    Lived lived = lived_in_read_states(model, states[state], so_far);
    for (const skeleton::Load& load : states[state].unread) {
        Borne borne = solve_as_far_as_it_bears(solver, k, load, lived.flowed);
        lived.whole = lived.whole && borne.whole;
        lived.unread.push_back(std::move(borne.equilibrium));
        lived.flowed = skeleton::flowed(model, lived.unread.back());
    }
    return lived;
}

}  // namespace palpate::identify
