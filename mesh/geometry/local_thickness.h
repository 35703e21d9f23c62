#pragma once

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// How thick a closed body is where it is thickest, but for a tenth of its skin [mm]: the diameter of the largest ball
/// that touches the skin from inside at a point, which nine tenths of the skin do not exceed. That of a plate, and of a
/// bar nearly the width; 2 V / A takes a bar for half as thick. Found by shrinking balls over some hundred points.
/// [Ma, Bae, Choi 2012] @pre the surface is closed and faces outward.
double local_thickness(const Surface& surface);

}  // namespace palpate::mesh
