#pragma once

#include <cstdint>

#include "identify/inference/particles/hamiltonian/density_with_gradient.h"
#include "identify/inference/particles/proposal.h"

namespace palpate::identify {

/// States of W Markov chains in a posterior pi, in the whitened coordinates z of a Gaussian q near it.
struct Chains {
    Eigen::MatrixXd z;          // (P x W)
    Eigen::VectorXd log_ratio;  // ln pi - ln q of each (W), -inf where there is no density
    Eigen::MatrixXd gradient;   // of log_ratio by z (P x W)

    int size() const { return static_cast<int>(z.cols()); }
};

/// Hamiltonian moves that leave q^(1-b) pi^b as it is. [Neal 2011; Beskos, Pinski, Sanz-Serna, Stuart 2011]
///
/// With momenta p ~ N(0, 1) the energy is |z|^2 / 2 + |p|^2 / 2 - b ln(pi / q). Its first two terms rotate (z, p),
/// which is integrated exactly; the last one kicks p. A step of an angle h is half a kick, a rotation by h, half a
/// kick. Where pi is q no proposal is rejected, so that acceptance does not fall with the number of directions, and h
/// is bounded by how far the curvature of pi differs from that of q. A trajectory of a quarter of a turn forgets where
/// it began.
class HamiltonianMoves {
public:
    HamiltonianMoves(const DensityWithGradient& density, const GaussianProposal& q, std::uint64_t seed, int threads)
        : density_(density), q_(q), log_peak_(q.log_peak()), seed_(seed), threads_(threads) {}

    /// Draws of q.
    Chains draw(int count, std::uint64_t round);
    /// One trajectory of every chain of about a quarter of a turn, in steps of about `angle`, which is drawn within 15
    /// % so that no orbit closes. Returns the mean acceptance probability.
    double move(Chains& chains, double b, double angle, std::uint64_t round);

    Eigen::MatrixXd parameters(const Eigen::MatrixXd& z) const { return q_.parameters(z); }
    /// ln q at z.
    double log_proposal(const Eigen::VectorXd& z) const { return log_peak_ - z.squaredNorm() / 2; }
    int evaluations() const { return evaluations_; }

private:
    void evaluate(Chains& chains);

    const DensityWithGradient& density_;
    const GaussianProposal& q_;
    double log_peak_;
    std::uint64_t seed_;
    int threads_;
    int evaluations_ = 0;  // of the density, with its gradient
};

}  // namespace palpate::identify
