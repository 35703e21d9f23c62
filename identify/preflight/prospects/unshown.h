#pragma once

#include <string>

#include "identify/effects/effect.h"

namespace palpate::identify {

/// Why an effect that has no numbers in a problem cannot show there, as a clause: "the body has no closed cavity".
std::string why_unshown(const EffectHypothesis& effect);

}  // namespace palpate::identify
