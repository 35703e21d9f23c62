#include "fem/effects/point/compliant_support.h"

#include <algorithm>

namespace palpate::fem {

PointTerms CompliantSupport::terms(const Vec3& X, const Vec3& x) const {
    const Vec3 u = x - X;
    return {.energy = 0.5 * k_ * u.squaredNorm(), .gradient = k_ * u, .hessian = k_ * Mat3::Identity()};
}

Eigen::VectorXd CompliantSupport::weights(const Points& rest, const Eigen::VectorXd& even) const {
    const Eigen::RowVector3d centre = even.transpose() * rest / even.sum();
    const Eigen::VectorXd square = (rest.rowwise() - centre).rowwise().squaredNorm();
    const double mean = even.dot(square) / even.sum();
    if (turning_ == 1 || mean == 0) return even;
    const double spread = even.dot(square.cwiseAbs2()) / even.sum() / (mean * mean) - 1;
    constexpr double least_spread = 0.05, most = 3;  // beyond, springs in the middle would push
    if (spread < least_spread) return even;
    const double s = std::clamp((turning_ - 1) / spread, -most, most);
    return even.array() * (1 + s * (square.array() / mean - 1));
}

KnownEffect known_compliant_support() {
    return {"compliant-support",
            {{"stiffness", "N/mm", Range::positive}, optional_parameter("turning", "1", Range::positive)},
            [](const EffectNumbers& numbers) -> Effects {
                const double turning = numbers.has("turning") ? numbers["turning"] : 1;
                return {.points = {std::make_shared<CompliantSupport>(numbers["stiffness"], turning)}};
            }};
}

}  // namespace palpate::fem
