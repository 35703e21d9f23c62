#pragma once

#include "skeleton/equilibrium.h"
#include "skeleton/load.h"
#include "skeleton/statics.h"

namespace palpate::identify {

/// The equilibrium under a load, or under what a model bears of it.
struct Borne {
    skeleton::Equilibrium equilibrium;
    skeleton::Load load;  // what is borne
    bool whole = true;    // all that was asked for
};

/// Contacts and pressure are lowered in steps of a fifth until there is an equilibrium.
/// `before`: how far the fibres had flowed. @throws SolverFailure where a tenth is still too much.
Borne solve_as_far_as_it_bears(skeleton::StaticsSolver& solver, const Eigen::VectorXd& k, skeleton::Load load,
                               const skeleton::FibreStates& before);

}  // namespace palpate::identify
