#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "mesh/types.h"

namespace palpate::pipeline {

/// JSON has no NaN: what is unknown is null.
inline nlohmann::json known(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

inline nlohmann::json numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace palpate::pipeline
