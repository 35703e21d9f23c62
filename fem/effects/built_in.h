#pragma once

#include <vector>

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// The effects that are known from the start: those of a body of any kind, and faults of a measurement. A row each,
/// whose physics lies in point/, material/ or surface/; how it is diagnosed and hidden has a row in identify/effects.
std::vector<KnownEffect> built_in_effects();

}  // namespace palpate::fem
