#pragma once

#include "skeleton/effects/effect.h"

namespace palpate::skeleton {

/// The effects of a body that are known from the start.
std::vector<KnownEffect> known_effects();

}  // namespace palpate::skeleton
