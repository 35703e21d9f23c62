#include "identify/fit/lived.h"

#include <algorithm>

#include "mesh/errors.h"

namespace palpate::identify {

bool remembers(const std::vector<StateReadings>& states) {
    return std::ranges::any_of(states, [](const StateReadings& s) { return s.before >= 0 || !s.unread.empty(); });
}

Lived lived_before(const skeleton::Model& model, skeleton::StaticsSolver& solver, const Eigen::VectorXd& k,
                   const std::vector<StateReadings>& states, int state,
                   const std::vector<skeleton::Equilibrium>& so_far, const std::vector<skeleton::Equilibrium>* near) {
    const StateReadings& own = states[state];
    Lived lived;
    if (own.before >= 0) {
        if (so_far[own.before].step.size() == 0) throw SolverFailure("a state before had no equilibrium");
        lived.flowed = skeleton::flowed(model, so_far[own.before]);
    }
    for (const skeleton::Load& load : own.unread) {
        const skeleton::State* start = near ? &(*near)[lived.unread.size()].state : nullptr;
        lived.unread.push_back(solver.solve(k, load, {}, start, lived.flowed));
        lived.flowed = skeleton::flowed(model, lived.unread.back());
    }
    return lived;
}

}  // namespace palpate::identify
