#include "identify/fit/borne.h"

#include "mesh/errors.h"

namespace palpate::identify {

Borne solve_as_far_as_it_bears(skeleton::StaticsSolver& solver, const Eigen::VectorXd& k, skeleton::Load load,
                               const skeleton::FibreStates& before) {
    constexpr int attempts = 10;
    constexpr double lowered = 0.8;
    for (int attempt = 0;; ++attempt) {
        try {
            return {solver.solve(k, load, {}, nullptr, before), load, attempt == 0};
        } catch (const SolverFailure&) {
            if (attempt == attempts) throw;
            for (skeleton::PointForce& force : load.forces) force.force *= lowered;
            for (skeleton::Press& press : load.presses) press.force *= lowered;
            load.pressure *= lowered;
        }
    }
}

}  // namespace palpate::identify
