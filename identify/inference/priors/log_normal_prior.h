#pragma once

#include <Eigen/Core>
#include <memory>

#include "identify/inference/priors/markov_field.h"

namespace palpate::identify {

inline constexpr double wide_sd = 3;    // of ln multipliers that many links share
inline constexpr double link_sd = 0.7;  // of ln one link's, round the uniform fit

/// What is believed of theta, log multipliers, before the measurements: normally distributed, independent or alike
/// where neighbours are. theta = mean + C v, with v ~ N(0, 1), C = diag(sd) or diag(sd) times the field's.
struct LogNormalPrior {
    Eigen::VectorXd mean, sd;                  // (P)
    std::shared_ptr<const MarkovField> field;  // over the parameters; none: independent

    Eigen::VectorXd whitened(const Eigen::VectorXd& theta) const;  // v
    double half_square(const Eigen::VectorXd& theta) const;        // |v|^2 / 2
    double log_density(const Eigen::VectorXd& theta) const;
    double log_root() const;                                                // ln |det C|
    Eigen::SparseMatrix<double> precision() const;                          // (C C^T)^-1
    Eigen::VectorXd precision_times(const Eigen::VectorXd& X) const;        // (C C^T)^-1 X
    Eigen::MatrixXd coloured(const Eigen::MatrixXd& V) const;               // C V, from v to theta (P x any)
    Eigen::MatrixXd gradients_by_v(const Eigen::MatrixXd& jacobian) const;  // C^T X, from slopes by theta
};

}  // namespace palpate::identify
