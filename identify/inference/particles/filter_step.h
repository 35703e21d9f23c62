#pragma once

#include <Eigen/Core>

namespace palpate::identify {

/// The particle set after a step of the filter.
struct FilterStep {
    double temperature = 0;  // tempered: 0 proposal .. 1 posterior; burion2008: iteration
    double effective_samples = 0;
    Eigen::MatrixXd particles;    // stiffnesses (particles x parameters), units as in the posterior
    Eigen::VectorXd log_weights;  // before resampling (particles), normalised
};

}  // namespace palpate::identify
