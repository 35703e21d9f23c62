#pragma once

#include "identify/inference/domains/position/position_domain.h"
#include "identify/inference/priors/log_normal_prior.h"
#include "identify/numerics/spectrum.h"

namespace palpate::identify {

/// J^T J of a domain's errors with respect to v, theta = mean + C v: its eigenvalues are the ratios of data to prior
/// information along each direction.
SymmetricProduct whitened_curvature(const ErrorJacobian& jacobian, const LogNormalPrior& prior);

struct FitOptions {
    int iterations = 60;
    double tolerance = 1e-8;  // stop when a step promises less of half the chi^2; more where directions are many
    /// Or when so many iterations lowered it by less than a hundred times that, where kinks keep the promise from
    /// coming true; 0: never.
    int patience = 0;
    const Spectrum* near = nullptr;  // of a fit nearby
    bool final_spectrum = true;      // else one on the way is left, good enough to count effective parameters
};

/// The most probable theta (MAP).
struct FitResult {
    Eigen::VectorXd theta;
    Prediction prediction;   // there
    double chi_squared = 0;  // of the errors there
    Spectrum spectrum;       // of the whitened curvature there
    int iterations = 0;
    std::vector<double> trace;  // half of chi^2 and prior at the start, and after each iteration (iterations + 1)
    int evaluations = 0;        // of all equilibria
    bool converged = false;
};

/// Gauss-Newton on half of chi^2 and prior, with backtracking, in log multipliers: stiffness stays positive by itself,
/// and a step is a ratio, of no more than e. A trial without equilibrium counts as no improvement.
///
/// In coordinates in which the prior is N(0, 1) the equations of a step are (1 + A) dv = -g, A = J^T J. The data inform
/// few directions, so A has few eigenvalues that are not small against 1: these are found once [Spectrum], and
/// precondition conjugate gradients from then on, which end after a few products, however many parameters there are;
/// where there are more than 128, the first of them do, and more products. A step that falls short is damped
/// [Levenberg 1944], and one that fell less than slopes promise shortens the next.
/// @throws SolverFailure when there is no equilibrium at the start, not even with stiffnesses hundreds of times larger.
FitResult fit_map(const PositionDomain& domain, const LogNormalPrior& prior, const Eigen::VectorXd& start, int threads,
                  const FitOptions& options = {});

/// The chi^2 that would be left after Gauss-Newton's next step from a fit, if errors went straight, under the sigmas
/// that the domain has now: those that the fit was made under were about sqrt(`sharper`) times as large. From above, as
/// the equations of the step are solved roughly.
double promised_chi_squared(const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
                            double sharper);

}  // namespace palpate::identify
