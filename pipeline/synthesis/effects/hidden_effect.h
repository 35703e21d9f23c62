#pragma once

#include <vector>

#include "pipeline/synthesis/effects/effect_sampler.h"
#include "pipeline/synthesis/effects/strength.h"

namespace palpate::pipeline {

/// How much an effect is to change the readings: about a share of the rms displacement, at least 5 sigma.
struct Target {
    double noise = 0;  // 1 sigma [mm]
    double share = 0.2;
};

struct HiddenEffect {
    skeleton::EffectRecord effect;
    bool is_specified = false;  // its strength was
    Strength strength;          // alone, over all histories
};

/// Gives an effect its strength: as specified, or sought until it changes the readings by the target. It is simulated
/// alone, on the first few probes, then on all. Samplers are tried in turn until 3 sigma of the change cannot be
/// explained by a common stiffness factor. Where it cannot be made that strong it is as strong as is sensible.
/// @throws InvalidInput for impossible numbers, SolverFailure when the body bears it at no strength.
HiddenEffect hide(const Specimen& specimen, const Plan& plan, const std::vector<EffectSampler>& samplers,
                  const Target& target, const SimulationOptions& options);

}  // namespace palpate::pipeline
