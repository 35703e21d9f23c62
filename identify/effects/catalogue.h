#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/effects/effect.h"

namespace palpate::identify {

/// Every effect that a diagnosis may name, in the order in which they are told.
const std::vector<std::shared_ptr<const EffectHypothesis>>& catalogue();
/// What stands for a source that was located and has no name: no diagnosis looks for it, models show it.
const std::vector<std::shared_ptr<const EffectHypothesis>>& unnamed_sources();
/// Both.
std::vector<std::shared_ptr<const EffectHypothesis>> all_effects();

/// Adds an effect of one's own in one row: its physics, and how it is diagnosed and hidden. Meant for a static object
/// of its file:
///   const bool known = register_effect({"swelling", {{"strain", "1"}}, make_swelling}, std::make_shared<Swelling>());
/// Always true. @throws InvalidInput when there is one of that name, or the two differ in name or kind; then neither is
/// added.
bool register_effect(skeleton::KnownEffect physics, std::shared_ptr<const EffectHypothesis> effect);

/// @throws InvalidInput naming the effects that there are, and the one that is spelled most alike.
std::shared_ptr<const EffectHypothesis> find_effect(const std::string& name);
/// The effect of that name; null: there is none.
std::shared_ptr<const EffectHypothesis> effect_named(const std::string& name);
/// The one that stands for readings which are off by themselves.
std::shared_ptr<const EffectHypothesis> effect_of_single_readings();

}  // namespace palpate::identify
