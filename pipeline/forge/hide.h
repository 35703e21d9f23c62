#pragma once

#include <vector>

#include "pipeline/forge/draft.h"
#include "pipeline/forge/strength.h"

namespace palpate::pipeline {

/// How much an effect is to change the readings: about a share of the rms displacement, at least 5 sigma.
struct Target {
    double noise = 0;  // 1 sigma [mm]
    double share = 0.2;
};

struct Hidden {
    skeleton::Effect effect;
    bool is_told = false;  // its strength was
    Strength strength;     // alone, over all courses
};

/// Gives an effect its strength: told, or sought until it changes the readings by the target. It is played alone, on
/// the first few probes, then on all. Drafts are tried in turn until 3 sigma are beyond a common stiffness, which
/// nobody could tell from another material. Where it cannot be made that strong it is as strong as is sensible.
/// @throws InvalidInput for impossible numbers, SolverFailure when the body bears it at no strength.
Hidden hide(const Specimen& specimen, const Plan& plan, const std::vector<Draft>& drafts, const Target& target,
            const PlayOptions& options);

}  // namespace palpate::pipeline
