#pragma once

#include <vector>

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

/// Equal parts of Gaussians, one a mode that is known. A place is told by theta and by z in the Gaussian `from`. Keeps
/// a reference to the Gaussians.
class GaussianMixture {
public:
    explicit GaussianMixture(const std::vector<GaussianProposal>& parts);

    int modes() const { return static_cast<int>(parts_.size()); }
    int dimension() const { return static_cast<int>(parts_.front().mean.size()); }
    /// theta of each column of z (P x n), which are of the Gaussians `from` (n).
    Eigen::MatrixXd parameters(const Eigen::MatrixXd& z, const std::vector<int>& from) const;
    /// The logarithm of each Gaussian's density (modes).
    Eigen::VectorXd log_densities(const Eigen::VectorXd& theta, const Eigen::VectorXd& z, int from) const;
    /// The same of the mixture.
    double log_density(const Eigen::VectorXd& theta, const Eigen::VectorXd& z, int from) const;

private:
    const std::vector<GaussianProposal>& parts_;
    std::vector<double> log_peaks_;
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
