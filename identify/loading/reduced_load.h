#pragma once

#include "skeleton/loads/load.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {

/// The equilibrium under a load, or under the largest fraction of it that has one.
struct ReducedLoadEquilibrium {
    skeleton::Equilibrium equilibrium;
    skeleton::Load load;       // what is borne
    bool is_full_load = true;  // the full load
};

/// Contacts and pressure are lowered in steps of a fifth until there is an equilibrium.
/// `before`: how far the fibres had flowed. @throws SolverFailure where a tenth is still too much.
ReducedLoadEquilibrium solve_with_reduced_load(skeleton::StaticsSolver& solver, const Eigen::VectorXd& k,
                                               skeleton::Load load, const skeleton::FibreStates& before);

}  // namespace palpate::identify
