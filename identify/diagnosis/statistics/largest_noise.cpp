#include "identify/diagnosis/statistics/largest_noise.h"

#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

namespace palpate::identify {

double largest_noise(Eigen::Index readings, double probability) {
    const auto N = static_cast<double>(readings);
    return std::sqrt(2 * boost::math::gamma_q_inv(N / 2, probability) / N);
}

}  // namespace palpate::identify
