#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/effects/effect.h"

namespace palpate::identify {

/// Every effect that is known, in the order in which they are told.
const std::vector<std::shared_ptr<const Effect>>& catalogue();

/// Adds an effect of one's own; meant for a static object of its file:
///   const bool registered = register_effect(std::make_shared<MyEffect>());
/// @throws InvalidInput when there is one of that name.
bool register_effect(std::shared_ptr<const Effect> effect);

/// @throws InvalidInput naming the effects that there are, and the one that is spelled most alike.
std::shared_ptr<const Effect> find_effect(const std::string& name);
/// The effect of that name; null: there is none.
std::shared_ptr<const Effect> effect_named(const std::string& name);
/// The one that stands for readings which are off by themselves.
std::shared_ptr<const Effect> effect_of_single_readings();

// Each effect, from its own file.
std::shared_ptr<const Effect> gravity_effect();
std::shared_ptr<const Effect> stiffening_effect();
std::shared_ptr<const Effect> anisotropy_effect();
std::shared_ptr<const Effect> inclusion_effect();
std::shared_ptr<const Effect> volume_effect();
std::shared_ptr<const Effect> torsion_effect();
std::shared_ptr<const Effect> shear_effect();
std::shared_ptr<const Effect> compliant_support_effect();
std::shared_ptr<const Effect> contact_effect();
std::shared_ptr<const Effect> pressure_effect();
std::shared_ptr<const Effect> prestress_effect();
std::shared_ptr<const Effect> viscosity_effect();
std::shared_ptr<const Effect> plasticity_effect();
std::shared_ptr<const Effect> misalignment_effect();
std::shared_ptr<const Effect> force_gain_effect();
std::shared_ptr<const Effect> outliers_effect();

}  // namespace palpate::identify
