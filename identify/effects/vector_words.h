#pragma once

#include <string>

#include "mesh/types.h"

namespace palpate::identify {

/// A direction in words: "-z" where it lies within ten degrees of an axis, else "(0.46, -0.01, -0.89)".
std::string direction_in_words(const Vec3& direction);

/// A vector that was fitted, by size and direction: "9.2 ± 0.5 m/s^2 along -z; along x it is not determined". Its part
/// along an axis that the readings do not determine enters neither. @param unit the size of one `unit_name`
std::string vector_in_words(const Vec3& v, const Mat3& covariance, double unit, const std::string& unit_name,
                            const std::string& preposition = "along");

}  // namespace palpate::identify
