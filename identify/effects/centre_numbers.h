#pragma once

#include "identify/effects/effect.h"

namespace palpate::identify {

/// cx, cy, cz [mm] of an effect that is somewhere in the body: its middle, more or less two sevenths of its extent. In
/// a sheet no place is known better before than to a hundredth of the largest extent.
std::vector<EffectNumber> centre_numbers(const BodyModel& model);

}  // namespace palpate::identify
