#pragma once

#include <cstdint>
#include <vector>

#include "identify/effects/hiding.h"
#include "pipeline/synthesis/effects/effect_spec.h"
#include "pipeline/synthesis/loading/load_plan.h"

namespace palpate::pipeline {

using identify::EffectSampler;

/// Samplers of an effect: specified values are kept, the others drawn. Several: alternative locations, for an effect
/// whose first location hardly changes the readings. Of an effect that a user made known one number may be left out,
/// which is then its strength. `which`: of those of this effect, each of which draws numbers of its own.
/// @throws InvalidInput for an effect or a number that is not known, with its likely spelling,
/// or an effect that cannot be on this specimen.
std::vector<EffectSampler> samplers_of(const Specimen& specimen, const Plan& plan, const EffectSpec& spec,
                                       const LoadTiming& timing, std::uint64_t seed, int which = 0);

/// Refuses names of effects and numbers that are not known, before anything is computed. @throws InvalidInput.
void check_spec(const EffectSpec& spec);

}  // namespace palpate::pipeline
