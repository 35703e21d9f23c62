#include "identify/loading/reduced_load.h"

#include "mesh/errors.h"

namespace palpate::identify {

ReducedLoadEquilibrium solve_with_reduced_load(skeleton::StaticsSolver& solver, const Eigen::VectorXd& k,
                                               skeleton::Load load, const skeleton::FibreStates& before) {
    constexpr int attempts = 10;
    constexpr double lowered = 0.8;
    for (int attempt = 0;; ++attempt) {
        try {
            return {solver.solve(k, load, {}, nullptr, before), load, attempt == 0};
        } catch (const SolverFailure&) {
            if (attempt == attempts) throw;
            for (skeleton::PointForce& force : load.forces) force.force *= lowered;
            for (skeleton::PatchForce& press : load.patch_forces) press.force *= lowered;
            load.pressure *= lowered;
        }
    }
}

}  // namespace palpate::identify
