#include "fem/effects/point/gravity.h"

namespace palpate::fem {

PointTerms Gravity::terms(const Vec3& X, const Vec3& x) const {
    return {.energy = -g_.dot(x - X), .gradient = -g_, .hessian = Mat3::Zero()};
}

KnownEffect known_gravity() {
    return {
        "gravity", {{"gx", "mm/s^2"}, {"gy", "mm/s^2"}, {"gz", "mm/s^2"}}, [](const EffectNumbers& numbers) -> Effects {
            return {.points = {std::make_shared<Gravity>(numbers.vector("gx", "gy", "gz"))}};
        }};
}

}  // namespace palpate::fem
