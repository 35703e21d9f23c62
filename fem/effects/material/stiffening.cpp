#include "fem/effects/material/stiffening.h"

#include "fem/large_deformation/elements/point_law.h"

namespace palpate::fem {

MaterialTerms Stiffening::terms(const Vec3& /*X*/, const Mat3& F, bool with_second) const {
    const PointLaw<MaterialLaw::neo_hookean> law(F);  // its D is x / 2
    const double x = 2 * law.D;
    const double by_x = x * (2 * c2_ + 3 * c3_ * x), by_x_twice = 2 * c2_ + 6 * c3_ * x;
    MaterialTerms result;
    result.w = x * x * (c2_ + c3_ * x);
    result.first = 2 * by_x * law.dD;
    if (!with_second) return result;
    for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) {
            result.second.block<3, 3>(Eigen::Index{3} * c, Eigen::Index{3} * d) =
                law.second(c, d, 2 * by_x, 0) + 4 * by_x_twice * law.dD.row(c).transpose() * law.dD.row(d);
        }
    }
    return result;
}

KnownEffect known_stiffening() {
    return {"stiffening",
            {{"c2", "1", Range::not_negative}, {"c3", "1", Range::not_negative}},
            [](const EffectNumbers& numbers) -> Effects {
                return {.material = {std::make_shared<Stiffening>(numbers["c2"], numbers["c3"])}};
            }};
}

}  // namespace palpate::fem
