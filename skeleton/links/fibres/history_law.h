#pragma once

#include <optional>

#include "skeleton/links/fibres/plastic_fibre.h"

namespace palpate::skeleton {

/// How a fibre's answer goes by what it has been through. With B(e) = e^2 / 2 + plastic_terms the elastic energy of a
/// fibre over Young's modulus, E = 3 mu, damage sees D = 3 B and takes damage_energy(D) / 3 off B.
struct HistoryLaw {
    std::optional<fem::Plasticity> plasticity = {};
    std::optional<fem::Damage> damage = {};

    explicit HistoryLaw(const fem::Effects& effects) : plasticity(effects.plasticity), damage(effects.damage) {}
    explicit operator bool() const { return plasticity || damage; }
};

/// What history adds to the elastic energy e^2 / 2 of a fibre stretched by lambda, as a share of Young's modulus [-].
StretchTerms history_terms(const HistoryLaw& law, const FibreState& before, double lambda);

/// What a fibre has been through once it was stretched by lambda.
FibreState after_stretch(const HistoryLaw& law, const FibreState& before, double lambda);

/// First order of both.
struct HistorySlopes {
    Eigen::Matrix<double, 3, 4> state;  // of FibreState's numbers, by lambda and by those before
    Eigen::RowVector3d stress;          // of the first derivative of the energy, by the numbers before
};
HistorySlopes history_slopes(const HistoryLaw& law, const FibreState& before, double lambda);

}  // namespace palpate::skeleton
