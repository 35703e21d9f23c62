#include "skeleton/effects/compliant_support.h"

namespace palpate::skeleton {

fem::PointTerms CompliantSupport::terms(const Vec3& X, const Vec3& x, bool with_parameters) const {
    const Vec3 u = x - X;
    fem::PointTerms terms{
        .energy = 0.5 * k_ * u.squaredNorm(), .gradient = k_ * u, .hessian = k_ * Mat3::Identity(), .by_parameter = {}};
    if (with_parameters) terms.by_parameter = terms.gradient;  // by ln k
    return terms;
}

}  // namespace palpate::skeleton
