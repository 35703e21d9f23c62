#include "fem/effects/material/prestress.h"

namespace palpate::fem {

Prestress::Prestress(const Mat3& S) : S_((S + S.transpose()) / 2) {}

MaterialTerms Prestress::terms(const Vec3& /*X*/, const Mat3& F, bool with_second) const {
    MaterialTerms result;
    result.first = F * S_;
    result.w = (F.cwiseProduct(result.first).sum() - S_.trace()) / 2;
    if (!with_second) return result;
    for (int c = 0; c < 3; ++c) result.second.block<3, 3>(Eigen::Index{3} * c, Eigen::Index{3} * c) = S_;
    return result;
}

KnownEffect known_prestress() {
    return {"prestress",
            {{"sxx", "1"}, {"syy", "1"}, {"szz", "1"}, {"sxy", "1"}, {"syz", "1"}, {"sxz", "1"}},
            [](const EffectNumbers& numbers) -> Effects {
                Mat3 S;
                S << numbers["sxx"], numbers["sxy"], numbers["sxz"],  //
                    numbers["sxy"], numbers["syy"], numbers["syz"],   //
                    numbers["sxz"], numbers["syz"], numbers["szz"];
                return {.material = {std::make_shared<Prestress>(S)}};
            }};
}

}  // namespace palpate::fem
