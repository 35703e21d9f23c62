#pragma once

#include "identify/fit/fit.h"

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
    /// The density's logarithm where z = 0; it falls by |z|^2 / 2.
    double log_peak() const;
};

/// Laplace's approximation at the fit, wider by 1 + 1 / P, so that the effective sample size stands it.
GaussianProposal laplace_proposal(const FitResult& fit, const LogNormalPrior& prior);

/// Moves the mean to where the posterior's slope, averaged over the proposal, is zero: the best of all Gaussians of
/// this covariance (least Kullback-Leibler divergence from them to the posterior). With thousands of links that each
/// may be half or twice as stiff, a body is softer or stiffer than by the links' middle values, by many sd of what the
/// measurements tell, so that Laplace's particles, round the mode, nearly all miss. Means over `pairs` z and -z, and
/// Newton's method with the proposal's own covariance, as long as ln pi rises on average. Draws without equilibrium
/// count nothing.
/// Returns how often all equilibria were solved.
int centre(GaussianProposal& proposal, const PositionDomain& domain, const LogNormalPrior& prior,
           const Prediction& near, int pairs, std::uint64_t seed, int threads);

/// The same for a mean of draws that lie +-offsets from it (P x pairs); `covariance`: theirs, times a vector, both in
/// coordinates in which the prior is N(0, 1).
int centre(Eigen::VectorXd& mean, const Eigen::MatrixXd& offsets,
           const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& covariance, const PositionDomain& domain,
           const LogNormalPrior& prior, const Prediction& near, int threads);

}  // namespace palpate::identify
