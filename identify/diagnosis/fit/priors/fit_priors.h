#pragma once

#include <utility>
#include <vector>

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {

/// A number with a prior of less sd, as the logarithm of a ratio that is told, counts as told: nothing is left to fit.
/// Design choice: such a prior tells it to a tenth already.
inline constexpr double told_prior_sd = 0.1;

/// What is believed of a fit's numbers x (n) before the measurements: independent normal distributions.
struct FitPriors {
    FitPriors(const BodyModel& model, const Explanation& explanation,
              const std::vector<std::vector<EffectNumber>>& numbers);
    /// Of numbers without bounds.
    FitPriors(Eigen::VectorXd means, Eigen::VectorXd sds) : mean(std::move(means)), sd(std::move(sds)) {}

    /// Half of the squares of what x is off, in sd, and its slope.
    double objective(const Eigen::VectorXd& x) const { return 0.5 * (x - mean).cwiseQuotient(sd).squaredNorm(); }
    Eigen::VectorXd slope(const Eigen::VectorXd& x) const { return (x - mean).cwiseQuotient(sd.cwiseAbs2()); }
    Eigen::VectorXd precisions() const { return sd.cwiseAbs2().cwiseInverse(); }

    Eigen::VectorXd mean, sd, least, most;
    Eigen::VectorXd step;  // how far a number may go at once: its prior's width, a logarithm at most a factor of two
    std::vector<Eigen::Index> weakly_identified;  // numbers that do not hold up the others
};

}  // namespace palpate::identify
