#pragma once

#include <Eigen/Core>

namespace palpate::identify {

/// Largest whitened rms of N readings with a noise of 1 sigma: exceeded by chance with a probability that is told.
/// [chi^2]
double largest_noise(Eigen::Index readings, double probability);

}  // namespace palpate::identify
