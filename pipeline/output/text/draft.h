#pragma once

#include <string>

#include "identify/effects/effect.h"

namespace palpate::pipeline {

/// A C++ source file for an effect of one's own that acts as a located one does, to be taken on from there. It builds
/// as it stands: -DPALPATE_OWN_EFFECTS=FILE.
/// @param name what it is to be called, in small letters and hyphens
/// @throws InvalidInput for an effect that is in the catalogue anyway, and as check_draft_name.
std::string draft_of(const skeleton::EffectRecord& effect, const std::string& name);

/// @throws InvalidInput for a name that is none or that is taken.
void check_draft_name(const std::string& name);

}  // namespace palpate::pipeline
