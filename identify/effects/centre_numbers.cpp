#include "identify/effects/centre_numbers.h"

#include <array>

namespace palpate::identify {

std::vector<EffectNumber> centre_numbers(const BodyModel& model) {
    constexpr double flat = 0.01;  // of the longest extent: a prior of width 0 would not be one
    const Eigen::RowVector3d low = model.pieces().colwise().minCoeff(), high = model.pieces().colwise().maxCoeff();
    const Eigen::RowVector3d centre = 0.5 * (low + high), extent = high - low;
    // a centre may be anywhere within: sqrt(12) = 3.5 sd of an even distribution are its width
    const Eigen::RowVector3d sd = extent.cwiseMax(flat * extent.maxCoeff()) / 3.5;
    std::vector<EffectNumber> result;
    result.reserve(3);
    for (int a = 0; a < 3; ++a) {
        result.push_back({.name = std::array{"cx", "cy", "cz"}[a],
                          .unit = "mm",
                          .start = centre[a],
                          .prior_mean = centre[a],
                          .prior_sd = sd[a]});
    }
    return result;
}

}  // namespace palpate::identify
