#include "skeleton/links/fibres/history_law.h"

#include <algorithm>
#include <cmath>

#include "fem/effects/material/damage.h"

namespace palpate::skeleton {

namespace {

/// B and its derivatives.
StretchTerms elastic_terms(const HistoryLaw& law, const FibreState& before, double lambda) {
    const double e = lambda - 1;
    StretchTerms B{0.5 * e * e, e, 1};
    if (law.plasticity) B += plastic_terms(*law.plasticity, before, lambda);
    return B;
}

FibreState flowed(const HistoryLaw& law, const FibreState& before, double lambda) {
    return law.plasticity ? flow(*law.plasticity, before, lambda) : before;
}

}  // namespace

StretchTerms history_terms(const HistoryLaw& law, const FibreState& before, double lambda) {
    StretchTerms sum;
    if (law.plasticity) sum = plastic_terms(*law.plasticity, before, lambda);
    if (!law.damage) return sum;
    const StretchTerms B = elastic_terms(law, before, lambda);
    const fem::DamageTerms by_D = fem::damage_energy(*law.damage, before.most, 3 * B.energy);
    sum += {by_D.energy / 3, by_D.first * B.first, by_D.first * B.second + 3 * by_D.second * B.first * B.first};
    return sum;
}

FibreState after_stretch(const HistoryLaw& law, const FibreState& before, double lambda) {
    FibreState now = flowed(law, before, lambda);
    const double elastic = lambda - 1 - now.strain;
    if (law.damage) now.most = std::max(before.most, 1.5 * elastic * elastic);
    return now;
}

HistorySlopes history_slopes(const HistoryLaw& law, const FibreState& before, double lambda) {
    HistorySlopes slopes;
    slopes.state << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
    slopes.stress.setZero();
    const FibreState now = flowed(law, before, lambda);
    const double elastic = lambda - 1 - now.strain;  // the stress without damage: dB/de
    Eigen::RowVector3d dB = Eigen::RowVector3d::Zero();
    if (law.plasticity) {
        slopes.state.topLeftCorner<2, 3>() = flow_derivatives(*law.plasticity, before, lambda);
        slopes.stress = -slopes.state.block<1, 3>(0, 1);
        // B is the least over the plastic strain, so it changes as where that stays.
        dB << -elastic, law.plasticity->hardening * (now.accumulated - before.accumulated), 0;
    }
    if (!law.damage) return slopes;

    const StretchTerms B = elastic_terms(law, before, lambda);
    const fem::DamageTerms by_D = fem::damage_energy(*law.damage, before.most, 3 * B.energy);
    slopes.stress = (1 + by_D.first) * slopes.stress + 3 * elastic * by_D.second * dB;
    slopes.stress[2] -= elastic * by_D.second;
    if (1.5 * elastic * elastic > before.most) {
        slopes.state.row(2) = -3 * elastic * slopes.state.row(0);
        slopes.state(2, 0) += 3 * elastic;
    }
    return slopes;
}

}  // namespace palpate::skeleton
