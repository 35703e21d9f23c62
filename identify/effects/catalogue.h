#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/effects/effect.h"

namespace palpate::identify {

/// Every effect that is known, in the order in which they are told.
const std::vector<std::shared_ptr<const EffectHypothesis>>& catalogue();

/// Adds an effect of one's own; meant for a static object of its file:
///   const bool registered = register_effect(std::make_shared<MyEffect>());
/// @throws InvalidInput when there is one of that name.
bool register_effect(std::shared_ptr<const EffectHypothesis> effect);

/// @throws InvalidInput naming the effects that there are, and the one that is spelled most alike.
std::shared_ptr<const EffectHypothesis> find_effect(const std::string& name);
/// The effect of that name; null: there is none.
std::shared_ptr<const EffectHypothesis> effect_named(const std::string& name);
/// The one that stands for readings which are off by themselves.
std::shared_ptr<const EffectHypothesis> effect_of_single_readings();

// Each effect, from its own file.
std::shared_ptr<const EffectHypothesis> gravity_effect();
std::shared_ptr<const EffectHypothesis> stiffening_effect();
std::shared_ptr<const EffectHypothesis> anisotropy_effect();
std::shared_ptr<const EffectHypothesis> inclusion_effect();
std::shared_ptr<const EffectHypothesis> volume_effect();
std::shared_ptr<const EffectHypothesis> torsion_effect();
std::shared_ptr<const EffectHypothesis> shear_effect();
std::shared_ptr<const EffectHypothesis> compliant_support_effect();
std::shared_ptr<const EffectHypothesis> contact_effect();
std::shared_ptr<const EffectHypothesis> pressure_effect();
std::shared_ptr<const EffectHypothesis> prestress_effect();
std::shared_ptr<const EffectHypothesis> viscosity_effect();
std::shared_ptr<const EffectHypothesis> plasticity_effect();
std::shared_ptr<const EffectHypothesis> misalignment_effect();
std::shared_ptr<const EffectHypothesis> force_gain_effect();
std::shared_ptr<const EffectHypothesis> outliers_effect();

}  // namespace palpate::identify
