#pragma once

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// A closed surface shifted along its normals until it encloses so much [mm^3]: what smoothing or chords took off is
/// given back. Each of three steps, dV = area x shift, leaves the square of what is lacking, as a share.
Surface with_volume(Surface surface, double volume);

}  // namespace palpate::mesh
