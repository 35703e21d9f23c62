#pragma once

#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// The skin as graphics programs know it: each vertex the mean of where at most four spheres would carry it rigidly.
struct FourInfluences {
    Eigen::Matrix<int, Eigen::Dynamic, 4> spheres;     // of each vertex; unused ones are 0
    Eigen::Matrix<double, Eigen::Dynamic, 4> weights;  // >= 0, add up to 1; unused ones are 0
    double relative_error = 0;  // rms over the skin's own displacement, in the deformations that it was fitted to
};

/// Fits the weights to how the skin moves under pushes that are spread over it, by least squares with weights that are
/// at least 0 and add up to 1; to the spheres' single motions where nothing holds the body.
FourInfluences four_influences(const skeleton::Model& model);

}  // namespace palpate::pipeline
