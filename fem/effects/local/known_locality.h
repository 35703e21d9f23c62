#pragma once

#include "fem/effects/known_effect.h"
#include "fem/effects/local/locality.h"

namespace palpate::fem {

// How files and users tell a locality: cx, cy, cz and radius.

std::vector<KnownParameter> locality_parameters();
Locality locality(const EffectNumbers& numbers);

}  // namespace palpate::fem
