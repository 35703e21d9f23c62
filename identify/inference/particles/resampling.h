#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::identify {

/// Subtracts from log weights the logarithm of their sum, so that the weights add up to 1, and returns it.
/// -inf is a weight of zero. @throws SolverFailure when all are zero.
double normalise(Eigen::VectorXd& log_weights);

/// 1 / sum w^2 of normalised log weights: how many equal particles would be worth as much.
double effective_samples(const Eigen::VectorXd& log_weights);

/// Low-variance resampling: one comb of `count` teeth laid over the cumulated weights at offset `u` in [0, 1).
/// A particle of weight w is taken floor or ceil (count w) times. [Thrun, Burgard, Fox 2005, table 4.4]
std::vector<int> low_variance_resample(const Eigen::VectorXd& log_weights, int count, double u);

/// Weights after going from temperature b by db, w (pi / q)^db; not normalised.
Eigen::VectorXd reweighted(const Eigen::VectorXd& log_weights, const Eigen::VectorXd& log_ratio, double db);

/// The largest step of temperature from b, up to 1, that leaves the wanted effective sample size; never zero.
double temperature_step(const Eigen::VectorXd& log_weights, const Eigen::VectorXd& log_ratio, double b, double wanted);

/// The value below which the share `q` of the weight lies; `weights` add up to 1.
double weighted_quantile(const Eigen::VectorXd& values, const Eigen::VectorXd& weights, double q);

}  // namespace palpate::identify
