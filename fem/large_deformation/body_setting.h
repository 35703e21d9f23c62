#pragma once

#include <vector>

#include "fem/effects/effects.h"
#include "fem/large_deformation/material_law.h"
#include "fem/material.h"

namespace palpate::fem {

/// What a body is made of and what acts on it besides contact forces.
struct BodySetting {
    MaterialLaw law = MaterialLaw::neo_hookean;
    Material material;
    Effects effects;
    std::vector<Material> regions = {};  // of the body's regions, in their order; none: all is of `material`
};

}  // namespace palpate::fem
