#include "fem/effects/contact.h"

namespace palpate::fem {

PointTerms ContactPlane::terms(const Vec3& /*X*/, const Vec3& x) const {
    const double gap = n_.dot(x) - offset_;
    if (gap >= 0) return {};
    return {.energy = k_ / 2 * gap * gap, .gradient = k_ * gap * n_, .hessian = k_ * n_ * n_.transpose()};
}

}  // namespace palpate::fem
