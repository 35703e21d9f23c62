#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fem/point_potential.h"

namespace palpate::skeleton {

/// A number of an effect.
struct EffectParameter {
    std::string name;  // "gx"
    double value = 0;
    std::string unit;  // "mm/s^2"
};

/// A physical effect that a model has beyond its links: a name of the catalogue and its numbers.
struct Effect {
    std::string name;
    std::vector<EffectParameter> parameters;
};

/// The physics of an effect. @throws InvalidInput for a name that is no effect of a body, a parameter that is missing,
/// unknown or out of range.
std::shared_ptr<const fem::PointPotential> make_potential(const Effect& effect);

}  // namespace palpate::skeleton
