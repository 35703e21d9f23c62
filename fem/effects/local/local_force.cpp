#include "fem/effects/local/local_force.h"

#include "fem/effects/local/known_locality.h"

namespace palpate::fem {

PointTerms LocalForce::terms(const Vec3& X, const Vec3& x) const {
    return {.energy = -force_.dot(x - X), .gradient = -force_, .hessian = Mat3::Zero()};
}

KnownEffect known_local_force() {
    std::vector<KnownParameter> parameters = locality_parameters();
    for (const char* component : {"fx", "fy", "fz"}) parameters.push_back({component, "N"});
    return {"local-force", std::move(parameters), [](const EffectNumbers& numbers) -> Effects {
                return {.points = {std::make_shared<LocalForce>(locality(numbers), numbers.vector("fx", "fy", "fz"))}};
            }};
}

}  // namespace palpate::fem
