#pragma once

#include "skeleton/statics/equilibrium.h"

namespace palpate::identify {

/// Free vibrations about an equilibrium, the slowest first: tangent s = w^2 M s, without damping.
struct Vibration {
    Eigen::VectorXd frequencies;  // w (n) [rad/s]
    Eigen::MatrixXd shapes;       // s, steps of the spheres (6N x n), s^T M s = 1 [1/sqrt(tonne)]

    int modes() const { return static_cast<int>(frequencies.size()); }
};

/// M v of steps or velocities (6N x any) in a state, of all spheres.
/// @throws InvalidInput naming a sphere that moves and has no mass or inertia.
Eigen::MatrixXd times_mass(const skeleton::Model& model, const skeleton::State& state, const Eigen::MatrixXd& v);

/// The slowest `modes` of them, or all that there are. `solver`: of the model, the tangent at the equilibrium factored.
/// @throws InvalidInput as times_mass; SolverFailure when they are not found.
Vibration vibration(const skeleton::Model& model, const skeleton::StaticsSolver& solver, const skeleton::State& state,
                    int modes);

}  // namespace palpate::identify
