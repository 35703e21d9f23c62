#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace palpate::identify {

/// What one specimen's run tells of one number x, the logarithm of a quantity that is positive.
struct SpecimenNumber {
    std::string specimen;
    Eigen::VectorXd draws;                    // of x from the run's posterior (J); one: it is normal about that
    Eigen::VectorXd weights;                  // of the draws (J), they add up to 1
    double sd = 0;                            // of that posterior, > 0
    double prior_mean = 0, prior_sd = 1e300;  // of the normal prior that the run had of x
};

/// A specimen within its population.
struct PooledSpecimen {
    std::string specimen;
    double own_mean = 0, own_sd = 0;  // of x as the specimen's own readings tell it, its run's prior taken off
    double mean = 0, sd = 0;          // as all specimens tell it together
    double p_value = 1;               // chance of one as far from the others, by what they and its readings tell
    bool is_outlying = false;         // less than one in twenty populations of this size has such a specimen
};

/// What specimens tell together of a number: x_i are normal about the population's mean with its spread.
///
/// Exact for what runs tell of their specimens: the likelihood of mean m and spread t is the product over specimens of
///   L_i(m, t) = int p_i(x) N(x; m, t^2) / N(x; prior_mean, prior_sd^2) dx,
/// p_i a run's posterior, by its draws as a mixture of normal densities with their mean and variance [Liu & West 2001],
/// so that a run's prior is replaced by the population. Summed over a grid of m and t. [Gelman et al., Bayesian Data
/// Analysis, ch. 5]
struct PooledNumber {
    double mean = 0, mean_sd = 0;
    double spread = 0, spread_low = 0, spread_high = 0;  // median, and 95 % of what is believed of it
    double next_mean = 0, next_sd = 0;                   // of a specimen that is yet to come
    std::vector<PooledSpecimen> specimens;
};

/// @param most_spread what is believed of the spread before: half-normal with this scale. @pre two specimens or more,
/// each with draws, priors wider than posteriors
PooledNumber pool(const std::vector<SpecimenNumber>& specimens, double most_spread);

}  // namespace palpate::identify
