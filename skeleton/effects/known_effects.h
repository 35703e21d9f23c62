#pragma once

#include "skeleton/effects/effect.h"

namespace palpate::skeleton {

/// The effects that are known from the start.
std::vector<KnownEffect> known_effects();

}  // namespace palpate::skeleton
