#pragma once

#include "identify/models/body_model.h"

namespace palpate::identify {

// Tools of which some coordinates are free, by what a model answers for tools whose coordinates are all told.
//
// Along its free directions D (6t x f) a tool is where no force acts, D^T W = 0, W its reactions. With their slopes by
// a step of the body, M^T, and by the pose, Z, the body alone feels the tools through
//   J_free = J - M D (D^T Z D)^-1 (M D)^T,
// and its inverse follows from J^-1 [Woodbury]. Directions that nothing resists, as a ball's turns, do not move.
// Turns are free in the components of the rotation vector; that these change with the turns themselves is left out of
// derivatives, which is exact where a tool turns about one fixed axis, or freely.

/// Is a coordinate of a tool free?
bool has_free_coordinates(const Action& action);

/// The action with the free coordinates that a configuration leads to.
/// @throws SolverFailure where none is found.
Action posed(const BodyModel& model, const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action);

/// As BodyModel has them. @throws SolverFailure where none is found.
Eigen::VectorXd equilibrium_with_free_tools(const BodyModel& model, const ModelSetting& setting, const Action& action,
                                            const Eigen::VectorXd* start, const Tangent* guide);
std::shared_ptr<const Tangent> tangent_with_free_tools(const BodyModel& model, const Eigen::VectorXd& q,
                                                       const ModelSetting& setting, const Action& action);
Eigen::MatrixXd tangent_times_with_free_tools(const BodyModel& model, const Eigen::VectorXd& q,
                                              const ModelSetting& setting, const Action& action,
                                              const Eigen::MatrixXd& steps);
ReactionSlopes reaction_slopes_with_free_tools(const BodyModel& model, const Eigen::VectorXd& q,
                                               const ModelSetting& setting, const Action& action);

}  // namespace palpate::identify
