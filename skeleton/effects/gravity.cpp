#include "skeleton/effects/gravity.h"

namespace palpate::skeleton {

fem::PointTerms Gravity::terms(const Vec3& X, const Vec3& x, bool with_parameters) const {
    fem::PointTerms terms{.energy = -g_.dot(x - X), .gradient = -g_, .hessian = Mat3::Zero(), .by_parameter = {}};
    if (with_parameters) terms.by_parameter = -Mat3::Identity();
    return terms;
}

}  // namespace palpate::skeleton
