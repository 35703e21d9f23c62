#pragma once

#include "identify/inference/maximum/fit_map.h"

namespace palpate::identify {

/// N(mean, wider C (1 + A)^-1 C^T) with the prior's C, and A known by its leading eigenpairs, where the filter's
/// particles come from; whitened coordinates z ~ N(0, 1).
struct GaussianProposal {
    Eigen::VectorXd mean;  // (P)
    LogNormalPrior prior;  // of which C
    Spectrum spectrum;     // of A, none: zero
    double wider = 1;

    /// theta of each column of z (P x n).
    Eigen::MatrixXd parameters(const Eigen::MatrixXd& z) const;
    /// z of theta.
    Eigen::VectorXd whitened(const Eigen::VectorXd& theta) const;
    /// Gradients by z, from those by theta (P x n).
    Eigen::MatrixXd gradients_by_z(const Eigen::MatrixXd& gradients) const;
    /// The density's logarithm where z = 0; it falls by |z|^2 / 2.
    double log_peak() const;
};

/// Laplace's approximation at the fit, wider by 1 + 1 / P, so that the effective sample size stands it.
GaussianProposal laplace_proposal(const FitResult& fit, const LogNormalPrior& prior);

/// Moves the mean of draws that lie +-offsets from it (P x pairs) to where the averaged gradient of likelihood and
/// prior vanishes. With thousands of links that each may be half or twice as stiff, a body is softer or stiffer than by
/// the links' middle values, by many sd of what the measurements tell, so that particles round the mode nearly all
/// miss. By Gauss and Newton, with the slopes at the fit: those at each draw pull towards less spread as well, which
/// stays as it is. As long as ln pi rises on average; pairs of which one has no equilibrium count nothing.
/// @param covariance the draws', times a vector, in coordinates in which the prior is N(0, 1)
/// @param fit where the slopes were taken
/// Returns how often all equilibria were solved.
int centre(Eigen::VectorXd& mean, const Eigen::MatrixXd& offsets, const ErrorJacobian& jacobian,
           const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& covariance, const PositionDomain& domain,
           const LogNormalPrior& prior, const FitResult& fit, int threads);

/// The same for a proposal round the fit, with so many pairs of draws from it.
int centre(GaussianProposal& proposal, const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
           int pairs, std::uint64_t seed, int threads);

}  // namespace palpate::identify
