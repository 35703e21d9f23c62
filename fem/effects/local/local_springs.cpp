#include "fem/effects/local/local_springs.h"

#include "fem/effects/local/known_locality.h"

namespace palpate::fem {

PointTerms LocalSprings::terms(const Vec3& X, const Vec3& x) const {
    const Vec3 u = x - X;
    return {.energy = 0.5 * k_ * u.squaredNorm(), .gradient = k_ * u, .hessian = k_ * Mat3::Identity()};
}

KnownEffect known_local_springs() {
    std::vector<KnownParameter> parameters = locality_parameters();
    parameters.push_back({"stiffness", "N/mm", Range::positive});
    return {"local-springs", std::move(parameters), [](const EffectNumbers& numbers) -> Effects {
                return {.points = {std::make_shared<LocalSprings>(locality(numbers), numbers["stiffness"])}};
            }};
}

}  // namespace palpate::fem
