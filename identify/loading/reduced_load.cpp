#include "identify/loading/reduced_load.h"

#include "identify/numerics/load_reduction.h"
#include "mesh/errors.h"

namespace palpate::identify {

ReducedLoadEquilibrium solve_with_reduced_load(skeleton::StaticsSolver& solver, const Eigen::VectorXd& k,
                                               skeleton::Load load, const skeleton::FibreStates& before) {
    for (int reductions = 0;; ++reductions) {
        try {
            return {solver.solve(k, load, {}, nullptr, before), load, reductions == 0};
        } catch (const SolverFailure&) {
            if (reductions == most_load_reductions) throw;
            for (skeleton::PointForce& force : load.forces) force.force *= load_reduction;
            for (skeleton::PatchForce& press : load.patch_forces) press.force *= load_reduction;
            load.pressure *= load_reduction;
        }
    }
}

}  // namespace palpate::identify
