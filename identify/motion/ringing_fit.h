#pragma once

#include "identify/inference/priors/log_normal_prior.h"
#include "identify/motion/damping_result.h"
#include "identify/motion/ringing.h"

namespace palpate::identify {

/// What is unknown of a body that rings, in the order of theta: ln of the slowest mode's ratio; for the law `both` the
/// logit of what mass has of it; ln of all frequencies; how late each recording's loads come [s]; then of each mode ln
/// of its ratio, frequency and amplitude over all that.
class RingdownFit {
public:
    /// Keeps a reference.
    RingdownFit(const Ringdowns& ringdowns, DampingLaw law);

    const LogNormalPrior& prior() const { return prior_; }

    double speed(const Eigen::VectorXd& theta) const;          // of all frequencies over the model's
    double common_ratio(const Eigen::VectorXd& theta) const;   // of the slowest mode, by the law
    double share_of_mass(const Eigen::VectorXd& theta) const;  // of that ratio
    /// The mode's ratio by the law, whose own one it is when `own`.
    Oscillator oscillator(const Eigen::VectorXd& theta, int mode, bool own) const;

    /// What recording r looks like (3m x t) [mm].
    Eigen::MatrixXd played(const Eigen::VectorXd& theta, int r) const;
    /// Weighed differences of a recording, less their mean over time of each coordinate: where a body comes to rest is
    /// known of its equilibria (3m x t).
    Eigen::MatrixXd errors(const Eigen::VectorXd& theta, int r) const;
    /// Half of their squares, of all recordings.
    double half_square(const Eigen::VectorXd& theta) const;

    /// The most probable theta when errors' squares are divided by `variance`, from a start.
    Eigen::VectorXd most_probable(const Eigen::VectorXd& start, double variance) const;
    /// The best of a grid of ratios and speeds, the rest as the prior's middle.
    Eigen::VectorXd scanned(double variance) const;
    /// d errors / d theta, of all readings (all x P).
    Eigen::MatrixXd jacobian(const Eigen::VectorXd& theta) const;

private:
    int own(int mode) const { return first_own_ + 3 * mode; }
    Eigen::VectorXd all_errors(const Eigen::VectorXd& theta) const;

    const Ringdowns& ringdowns_;
    DampingLaw law_;
    int speed_ = 1, delay_ = 2, first_own_ = 3;
    LogNormalPrior prior_;
};

}  // namespace palpate::identify
