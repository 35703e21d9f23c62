#pragma once

#include <Eigen/SparseCore>

#include "skeleton/links/fibres/plastic_fibre.h"
#include "skeleton/links/rest_direction.h"
#include "skeleton/loads/load.h"
#include "skeleton/model/state.h"

namespace palpate::skeleton {

// All here with the model's effects in force, and `extra` ones; nothing was borne before.

/// Force signatures (6N x stiffnesses, in their order): each column the force on the spheres at unit stiffness. The net
/// force is external_force + effect_force + link_forces * k, linear in the stiffnesses. [Burion 2008, eqs. 7-8 with
/// the sum kept]
Eigen::SparseMatrix<double> link_forces(const Model& model, const State& state, const fem::Effects& extra = {});

/// All stiffnesses, ordered as StiffnessOrder says.
Eigen::VectorXd stiffness_vector(const Model& model);
/// Sets them; the links keep their sections.
void set_stiffness(Model& model, const Eigen::VectorXd& k);

/// Force of the effects that are not in the links (6N), at held spheres too [N, N mm].
/// @throws InvalidInput as make_physics, and when the model has nothing that an effect acts on.
Eigen::VectorXd effect_force(const Model& model, const State& state, const fem::Effects& extra = {});

/// Total elastic energy less the work of dead forces, and the effects' energy [N mm]; the residual is minus its
/// derivative.
double potential(const Model& model, const State& state, const Load& load, const fem::Effects& extra = {});

/// Net generalized force on each sphere (6N), zero in equilibrium but at held spheres; there minus the reaction.
Eigen::VectorXd residual(const Model& model, const State& state, const Load& load, const fem::Effects& extra = {});

/// Second derivative of the potential by the step, in exponential coordinates (6N x 6N), symmetric [N/mm, N, N mm];
/// in equilibrium it is -d residual / d step. `before`: what the links' fibres had been through.
Eigen::SparseMatrix<double> tangent(const Model& model, const State& state, const Load& load,
                                    const fem::Effects& extra = {}, const FibreStates& before = {});

}  // namespace palpate::skeleton
