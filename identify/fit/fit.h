#pragma once

#include "identify/fit/position_domain.h"

namespace palpate::identify {

/// What is believed of theta before the measurements: independent normal distributions.
struct LogNormalPrior {
    Eigen::VectorXd mean, sd;  // of the log multipliers (P)

    double half_square(const Eigen::VectorXd& theta) const;  // half the squared distance in sd
    double log_density(const Eigen::VectorXd& theta) const;
};

struct FitOptions {
    int iterations = 60;
    double tolerance = 1e-8;  // stop when the next step promises to lower half the chi^2 by less
};

/// The most probable theta (MAP).
struct FitResult {
    Eigen::VectorXd theta;
    Prediction prediction;    // there
    double chi_squared = 0;   // of the errors there
    Eigen::MatrixXd hessian;  // Gauss-Newton's, of half the chi^2 and the prior (P x P)
    int iterations = 0;
    int evaluations = 0;  // of all equilibria
    bool converged = false;
};

/// Levenberg-Marquardt on half of chi^2 and prior, damped as Nielsen [1999] has it, in log multipliers: stiffness stays
/// positive by itself, and a step is a ratio. A trial without equilibrium counts as no improvement.
/// @throws SolverFailure when there is no equilibrium at the start, not even with stiffnesses hundreds of times larger.
FitResult fit_map(const PositionDomain& domain, const LogNormalPrior& prior, const Eigen::VectorXd& start, int threads,
                  const FitOptions& options = {});

}  // namespace palpate::identify
