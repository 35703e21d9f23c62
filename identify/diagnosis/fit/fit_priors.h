#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {

/// What is believed of a fit's numbers x (n) before the measurements: independent normal distributions; of the vector
/// that an effect's numbers are its magnitude instead, where that is known, in any direction:
///   p(v) = N(|v|; mean, sd) / (4 pi |v|^2)
struct FitPriors {
    FitPriors(const BodyModel& model, const Explanation& explanation,
              const std::vector<std::vector<EffectNumber>>& numbers);
    /// Of numbers without bounds.
    FitPriors(Eigen::VectorXd means, Eigen::VectorXd sds) : mean(std::move(means)), sd(std::move(sds)) {}

    /// With the known magnitude of an effect's numbers in the place of its normal distributions; none: no effect has
    /// one.
    std::optional<FitPriors> with_magnitude(const Explanation& explanation) const;

    /// -ln p(x) less a constant, its derivatives, the second to Gauss-Newton's order, and that constant less
    /// n ln(2 pi) / 2, which Laplace's approximation takes away.
    double objective(const Eigen::VectorXd& x) const;
    Eigen::VectorXd slope(const Eigen::VectorXd& x) const;
    Eigen::MatrixXd precision(const Eigen::VectorXd& x) const;
    double log_scale() const;

    /// How far the magnitude of x is from the known one, in sd of the two together. `covariance`: of x (n x n).
    /// @pre a magnitude is known
    double magnitude_in_sd(const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance) const;

    Eigen::VectorXd mean, sd, least, most;
    Eigen::VectorXd step;  // how far a number may go at once: its prior's width, a logarithm at most a factor of two
    std::vector<Eigen::Index> weakly_identified;  // numbers that do not hold up the others

private:
    struct Magnitude {
        Eigen::Index first;  // of three numbers
        MagnitudePrior prior;
    };
    Eigen::VectorXd precisions() const;  // 0 of numbers whose magnitude is known

    std::optional<Magnitude> magnitude_;
};

}  // namespace palpate::identify
