#include "fem/large_deformation/elements/element_effects.h"

namespace palpate::fem {

namespace {

/// w0 + P0:H + 1/2 H:A0:H with H = F - I.
MaterialTerms linear_terms(const MaterialEffect& effect, const Vec3& X, const Mat3& F) {
    MaterialTerms terms = effect.terms(X, Mat3::Identity(), true);
    using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const Rows H = F - Mat3::Identity();
    const Eigen::Matrix<double, 9, 1> change = terms.second * H.reshaped<Eigen::RowMajor>();
    const Rows by_F = change.reshaped<Eigen::RowMajor>(3, 3);
    terms.w += (terms.first + by_F / 2).cwiseProduct(H).sum();
    terms.first += by_F;
    return terms;
}

}  // namespace

MaterialTerms ElementEffects::added(MaterialLaw law, int q, const Mat3& F, bool with_second) const {
    const Vec3 at = X.row(q);
    const auto of = [&](const MaterialEffect& effect) {
        return law == MaterialLaw::linear ? linear_terms(effect, at, F) : effect.terms(at, F, with_second);
    };
    const auto history = [&] {
        const MaterialPoint had = before ? before[q] : MaterialPoint{};
        MaterialTerms terms;
        if (plasticity) terms = plastic_terms(law, *plasticity, had.plastic, F, flows, with_second);
        return damage ? terms + damage_terms(law, *damage, had.most, F, terms, with_second) : terms;
    };
    if (energies.empty()) return history();
    MaterialTerms sum = of(*energies.front());
    for (const MaterialEffect* effect : energies.subspan(1)) sum = sum + of(*effect);
    if (plasticity || damage) sum = sum + history();
    return sum;
}

}  // namespace palpate::fem
