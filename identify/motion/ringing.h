#pragma once

#include <vector>

#include "identify/measurements/measurement_set.h"
#include "identify/motion/vibration.h"

namespace palpate::identify {

/// Damped free vibration x'' + 2 ratio w x' + w^2 x = 0.
struct Oscillator {
    double frequency = 0;  // w [rad/s], > 0
    double ratio = 0;      // >= 0

    /// Place and velocity a time later. [Thomson & Dahleh 1998, ch. 2]
    Eigen::Vector2d after(double time, const Eigen::Vector2d& start) const;
};

/// A recording seen from a model: equilibria that the loads lead to, and how far the modes are off them.
struct Ringdown {
    /// While one load acts.
    struct Stretch {
        double begins = 0;      // [s]
        Eigen::VectorXd jump;   // of the modes' deviation when it begins: the equilibrium before less that now (n)
        Eigen::VectorXd rests;  // coordinates of the markers in its equilibrium (3m) [mm]
    };
    std::vector<Stretch> stretches;
    Eigen::VectorXd times;     // of the instants (t) [s]
    Eigen::MatrixXd measured;  // coordinates of the markers (3m x t) [mm], NaN where missing
    Eigen::MatrixXd weights;   // 1 / sigma of each; 1 everywhere when no noise is told, 0 where missing

    /// What the markers do when the modes are these oscillators, their deviations `gain` times as large, and the loads
    /// come `delay` seconds after their time (3m x t) [mm].
    Eigen::MatrixXd played(const Eigen::MatrixXd& shapes, const std::vector<Oscillator>& modes,
                           const Eigen::VectorXd& gain, double delay) const;
};

/// All recordings of a set, seen from a model, and its modes about the last equilibrium.
struct Ringdowns {
    Vibration vibration;
    Eigen::MatrixXd shapes;  // of the modes at the markers (3m x n)
    std::vector<Ringdown> recordings;
};

/// @throws InvalidInput as vibration and equilibrium; SolverFailure likewise.
Ringdowns ringdowns(const skeleton::Model& model, const MeasurementSet& set, int modes);

/// The same of some of the modes.
Ringdowns of_modes(const Ringdowns& all, const std::vector<int>& which);

}  // namespace palpate::identify
