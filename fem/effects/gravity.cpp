#include "fem/effects/gravity.h"

namespace palpate::fem {

PointTerms Gravity::terms(const Vec3& X, const Vec3& x) const {
    return {.energy = -g_.dot(x - X), .gradient = -g_, .hessian = Mat3::Zero()};
}

}  // namespace palpate::fem
