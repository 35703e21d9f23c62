#pragma once

#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// Unit vector from a to b at rest. @throws InvalidInput when the two spheres have the same centre.
Vec3 rest_direction(const Model& model, const Link& link);

}  // namespace palpate::skeleton
