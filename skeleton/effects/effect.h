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

/// Is an effect the body's, whether known or not? `misalignment`, `force-gain` and `outliers` are faults of a
/// measurement: a model records them, and plays without.
bool is_body_effect(const std::string& name);

/// The physics of an effect. @throws InvalidInput for a name that is no effect of a body, a parameter that is missing,
/// unknown, in another unit or out of range.
std::shared_ptr<const fem::PointPotential> make_potential(const Effect& effect);

/// The physics of all that are the body's, in their order. @throws as make_potential.
fem::Potentials potentials_of(const std::vector<Effect>& effects);

}  // namespace palpate::skeleton
