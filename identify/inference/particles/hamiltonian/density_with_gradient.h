#pragma once

#include <Eigen/Core>
#include <functional>

namespace palpate::identify {

/// Logarithm of an unnormalised density at theta, -inf where there is none, and its gradient by theta (P), which then
/// does not matter. Called from several threads at once.
using DensityWithGradient = std::function<double(const Eigen::VectorXd& theta, Eigen::VectorXd& gradient)>;

}  // namespace palpate::identify
