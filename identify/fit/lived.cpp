#include "identify/fit/lived.h"

#include <algorithm>

#include "mesh/errors.h"

namespace palpate::identify {

bool remembers(const std::vector<StateReadings>& states) {
    return std::ranges::any_of(states, [](const StateReadings& s) { return s.before >= 0 || !s.unread.empty(); });
}

skeleton::FibreStates flowed_before(const skeleton::Model& model, skeleton::StaticsSolver& solver,
                                    const Eigen::VectorXd& k, const std::vector<StateReadings>& states, int state,
                                    const std::vector<skeleton::Equilibrium>& so_far) {
    const StateReadings& own = states[state];
    skeleton::FibreStates before;
    if (own.before >= 0) {
        if (so_far[own.before].step.size() == 0) throw SolverFailure("a state before had no equilibrium");
        before = skeleton::flowed(model, so_far[own.before]);
    }
    for (const skeleton::Load& load : own.unread) {
        before = skeleton::flowed(model, solver.solve(k, load, {}, nullptr, before));
    }
    return before;
}

}  // namespace palpate::identify
