#include "skeleton/effects/compliant_support.h"

namespace palpate::skeleton {

fem::PointTerms CompliantSupport::terms(const Vec3& X, const Vec3& x) const {
    const Vec3 u = x - X;
    return {.energy = 0.5 * k_ * u.squaredNorm(), .gradient = k_ * u, .hessian = k_ * Mat3::Identity()};
}

}  // namespace palpate::skeleton
