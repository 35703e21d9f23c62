#pragma once

#include <string>
#include <vector>

#include "fem/effects/known_effect.h"

// The one registry of effects, fem::EffectRegistry, with what links alone have: as models and all above see it.

namespace palpate::skeleton {

/// An effect that a model has beyond its links.
using EffectRecord = fem::EffectRecord;
using fem::EffectKind, fem::EffectNumbers, fem::EffectParameter, fem::KnownEffect, fem::KnownParameter, fem::Range;

/// Makes an effect known, to all models of this program: a static object of any source file may do so,
///   const bool known = register_effect({"surface-tension", {{"gamma", "N/mm"}}, make_surface_tension});
/// Safe from several threads. Always true. @throws InvalidInput when the name is known already.
bool register_effect(KnownEffect effect);

/// The effect of that name; null when there is none. It stays where it is.
const KnownEffect* find_known_effect(const std::string& name);

/// Is an effect the body's, whether known or not? Others are faults of a measurement: a model records them, and plays
/// without.
bool is_body_effect(const std::string& name);

/// The physics of an effect. @throws InvalidInput for a name that is no effect of a body, a parameter that is missing,
/// unknown, in another unit or out of range.
fem::Effects make_physics(const EffectRecord& effect);

/// The physics of all that are the body's, and `more`. @throws as make_physics.
fem::Effects physics_of(const std::vector<EffectRecord>& effects, const fem::Effects& more = {});

}  // namespace palpate::skeleton
