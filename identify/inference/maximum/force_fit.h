#pragma once

#include "identify/inference/domains/force/force_domain.h"
#include "identify/inference/priors/log_normal_prior.h"

namespace palpate::identify {

/// The posterior of log multipliers in the force domain: net forces are normally distributed round zero with one sd.
///   -ln pi = e(m) / (2 sigma^2) + rows ln(sigma sqrt(2 pi)) - ln prior,  m = exp(theta),  e = m^T H m + 2 g^T m + c
struct ForcePosterior {
    ForceStatistics statistics;
    LogNormalPrior prior;
    double sigma = 1;  // [N]

    double log_density(const Eigen::VectorXd& theta) const;
};

/// What net forces leave at the best multipliers >= 0, as an unfitted reading would see it: the sd of a net force [N].
double force_noise(const ForceStatistics& statistics, const Eigen::VectorXd& multipliers);

struct ForceFit {
    Eigen::VectorXd theta;
    std::shared_ptr<const MarkovField>
        spread;                 // of the posterior next to it: Laplace's, with Gauss and Newton's curvature
    std::vector<double> trace;  // -ln density at the start and after each step
};

/// The most probable theta, by Gauss and Newton's method from `start`: the curvature M H M / sigma^2 + the prior's
/// precision is as sparse as the links' neighbourhoods, one Cholesky factorisation a step.
ForceFit fit_forces(const ForcePosterior& posterior, const Eigen::VectorXd& start);

}  // namespace palpate::identify
