#pragma once

#include "identify/inference/maximum/calibrate.h"

namespace palpate::identify {

constexpr double least_told = 1e-3;  // ratio of data to prior information of a direction, below which it is left out

/// One reading's forecast from a mean v, in coordinates in which the prior is N(0, 1), and its derivatives there.
struct LinearisedReading {
    Eigen::VectorXd d;         // errors over sigma (3m)
    Eigen::VectorXd variance;  // of each, beside what is not known: the sigmas let a state's readings count once (3m)
    Eigen::MatrixXd W;         // orthonormal directions that it tells about (P x k)
    Eigen::MatrixXd B;         // J W = -B (3m x k)
    double squared_error = 0;  // of the markers [mm^2], over all coordinates
};

/// @pre domain: of that reading alone. @throws SolverFailure where the model has no equilibrium.
LinearisedReading linearise(const PositionDomain& domain, const Calibration& calibration, const Eigen::VectorXd& v);

/// Probability of an error at least as large as the forecast's, from a posterior N(v, (1 + A)^-1).
double p_value(const LinearisedReading& reading, const Spectrum& A);

}  // namespace palpate::identify
