#include "fem/large_deformation/elements/material_point.h"

#include <algorithm>

#include "fem/effects/material/damage.h"
#include "fem/large_deformation/elements/point_law.h"

namespace palpate::fem {

namespace {

/// The law's own distortion.
template <MaterialLaw law>
MaterialTerms distortion_of(const Mat3& F, bool with_second) {
    const PointLaw<law> own(F);
    MaterialTerms terms{own.D, own.dD};
    if (!with_second) return terms;
    for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) {
            terms.second.template block<3, 3>(Eigen::Index{3} * c, Eigen::Index{3} * d) = own.second(c, d, 1, 0);
        }
    }
    return terms;
}

MaterialTerms distortion(MaterialLaw law, const Mat3& F, bool with_second) {
    switch (law) {
        case MaterialLaw::linear:
            return distortion_of<MaterialLaw::linear>(F, with_second);
        case MaterialLaw::svk:
            return distortion_of<MaterialLaw::svk>(F, with_second);
        default:
            return distortion_of<MaterialLaw::neo_hookean>(F, with_second);
    }
}

}  // namespace

MaterialTerms damage_terms(MaterialLaw law, const Damage& damage, double most, const Mat3& F, const MaterialTerms& flow,
                           bool with_second) {
    const MaterialTerms elastic = distortion(law, F, with_second) + flow;
    const DamageTerms by_D = damage_energy(damage, most, elastic.w);
    MaterialTerms terms{by_D.energy, by_D.first * elastic.first};
    if (!with_second) return terms;
    const auto dD = elastic.first.reshaped<Eigen::RowMajor>();  // rows first, as MaterialTerms counts
    terms.second = by_D.first * elastic.second + by_D.second * dD * dD.transpose();
    return terms;
}

MaterialPoint material_point(MaterialLaw law, const std::optional<Plasticity>& plasticity,
                             const std::optional<Damage>& damage, const MaterialPoint& before, const Mat3& F) {
    MaterialPoint after = before;
    if (plasticity) after.plastic = plastic_point(law, *plasticity, before.plastic, F);
    if (!damage) return after;
    double D = distortion(law, F, false).w;
    if (plasticity) D += plastic_terms(law, *plasticity, after.plastic, F, false, false).w;
    after.most = std::max(before.most, D);
    return after;
}

}  // namespace palpate::fem
