#pragma once

#include "identify/inference/identify_result.h"

namespace palpate::python {

/// Weighted draws of stiffnesses, a column a row of the posterior.
struct Posterior {
    std::vector<identify::PosteriorRow> rows;
    Eigen::MatrixXd draws;    // (draws x parameters), units as in the rows
    Eigen::VectorXd weights;  // (draws), they add up to 1
};

}  // namespace palpate::python
