#pragma once

#include "mesh/types.h"

namespace palpate::skeleton {

/// Second derivative by w of f . r, where the arm r turns to r + w x r + 1/2 w x (w x r), in exponential coordinates.
inline Mat3 turning_curvature(const Vec3& f, const Vec3& r) {
    const Mat3 fr = 0.5 * f * r.transpose();
    return fr + fr.transpose() - f.dot(r) * Mat3::Identity();
}

}  // namespace palpate::skeleton
