#pragma once

#include "mesh/core/surface.h"

namespace palpate::samples {

/// A made-up organ, 180 mm long: a thick lobe that thins out to one side, with a dent where vessels would enter.
///
/// A sphere, pulled to an ellipsoid and bent; closed, outward, without sharp edges.
mesh::Surface make_organ();

}  // namespace palpate::samples
