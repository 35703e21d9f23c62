#pragma once

#include "identify/inference/identify_result.h"
#include "identify/inference/maximum/fit_map.h"
#include "identify/inference/particles/tempered_filter.h"

namespace palpate::identify {

/// Mean and sd of stiffnesses before the measurements, and the sd of their logarithms (P).
struct StiffnessPrior {
    Eigen::VectorXd mean, sd;
    Eigen::VectorXd log_sd;  // infinite: not told by logarithms
};

/// Of log multipliers: the mean of the log-normal exp(N(m, s^2)) is exp(m + s^2 / 2), its sd the mean times
/// sqrt(exp(s^2) - 1).
StiffnessPrior stiffness_prior(const Parameters& parameters, const LogNormalPrior& prior);

/// Of multipliers that lie evenly in [low, high].
StiffnessPrior stiffness_prior(const Parameters& parameters, double low, double high);

/// A row per parameter, of weighted particles (N x P) of stiffnesses. Informed where the sd has fallen to 0.7 of the
/// prior's or less, in the stiffness and in its logarithm: a wide log-normal's sd rests on its tail, which few
/// particles see.
std::vector<PosteriorRow> posterior_rows(const Parameters& parameters, const Eigen::MatrixXd& particles,
                                         const Eigen::VectorXd& log_weights, const StiffnessPrior& prior);

/// Pairs of parameters whose logarithms hang together by 0.7 or more among weighted particles (N x P) of stiffnesses,
/// the strongest first, at most 100: of parameters of which something is known, with an sd of at most 0.9 of the
/// prior's logarithm (P), as what the measurements tie together they narrow. With few independent draws some
/// correlations arise by chance: the threshold is then raised until fewer than one false positive is expected. [Fisher
/// 1915]
std::vector<Correlation> strong_correlations(const Eigen::MatrixXd& particles, const Eigen::VectorXd& log_weights,
                                             const Eigen::VectorXd& prior_log_sd, double independent);

/// Stiffnesses of particles of log multipliers (N x P).
Eigen::MatrixXd stiffness_of(const Parameters& parameters, const Eigen::MatrixXd& theta);

/// Summarises a filter's particles of log multipliers in a result: rows, best, modes, correlations, history, evidence.
/// `mode_locations`: theta at the modes that its Gaussians stand at.
void report_particles(const Parameters& parameters, const LogNormalPrior& prior,
                      const std::vector<Eigen::VectorXd>& mode_locations, TemperedResult& filter,
                      IdentifyResult& result);

}  // namespace palpate::identify
