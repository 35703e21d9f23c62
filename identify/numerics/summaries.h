#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <ranges>

// Numbers that stand for several others, or for one that is not known.

namespace palpate::identify {

/// 95 % of a normal distribution lie within so many standard deviations of its mean: Phi^-1(0.975).
inline constexpr double sds_of_95_percent = 1.959964;

/// ln of the mean of exp(x), without overflow: the evidence of equally likely alternatives. @pre the largest is finite
template <std::ranges::sized_range Logarithms>
double log_mean_exp(const Logarithms& logarithms) {
    const double most = std::ranges::max(logarithms);
    double mean = 0;
    for (const double one : logarithms)
        mean += std::exp(one - most) / static_cast<double>(std::ranges::size(logarithms));
    return most + std::log(mean);
}

/// 0 in place of what is not known or left free (NaN).
inline double known_part(double value) { return std::isnan(value) ? 0 : value; }
inline Eigen::Vector3d known_part(const Eigen::Vector3d& v) {
    return v.array().isNaN().select(Eigen::Vector3d::Zero(), v);
}

}  // namespace palpate::identify
