#pragma once

#include "identify/models/body_statics.h"
#include "identify/models/rig.h"

namespace palpate::identify {

/// Does every tool of `action` stand somewhere in `before`, so that its path from there is known?
bool is_reached_from(const Action& before, const Action& action);

/// The action with its tools still on their straight path from where they stand in `before`, a share (0 to 1) of it
/// gone.
/// @pre is_reached_from(before, action).
Action on_the_way(const Action& before, const Action& action, double share);

/// The equilibrium of `action` by way of that of `before`, q: tools go over on a straight path in parts, none of which
/// takes one past what it touches; sought from rest where that finds none. Under tools that press deep a body may have
/// several equilibria: which of them it is in, the path tells.
/// @pre is_reached_from(before, action). @throws SolverFailure as BodyStatics::equilibrium.
Eigen::VectorXd equilibrium_after(const BodyStatics& body, const PreparedRig& rig, const ModelSetting& setting,
                                  const Action& before, const Eigen::VectorXd& q, const Action& action);

}  // namespace palpate::identify
