#include "fem/effects/point/contact.h"

namespace palpate::fem {

PointTerms ContactPlane::terms(const Vec3& /*X*/, const Vec3& x) const {
    const double gap = n_.dot(x) - offset_;
    if (gap >= 0) return {};
    return {.energy = k_ / 2 * gap * gap, .gradient = k_ * gap * n_, .hessian = k_ * n_ * n_.transpose()};
}

KnownEffect known_contact() {
    return {"contact",
            {{"nx", "1"}, {"ny", "1"}, {"nz", "1"}, {"offset", "mm"}, {"stiffness", "N/mm^3", Range::positive}},
            [](const EffectNumbers& numbers) -> Effects {
                return {.points = {std::make_shared<ContactPlane>(numbers.direction("n"), numbers["offset"],
                                                                  numbers["stiffness"])}};
            }};
}

}  // namespace palpate::fem
