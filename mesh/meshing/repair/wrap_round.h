#pragma once

#include "mesh/core/surface.h"

namespace palpate::mesh {

struct Wrapping {
    Surface surface;
    double alpha = 0;  // no hole or gap narrower than this is entered [mm]
};

/// Alpha wrapping as the last resort: a sound surface round everything, then back onto what was wrapped as far as that
/// leaves it sound. Alpha is a hundredth of the diagonal, or less where that would fill gaps of the body.
/// @param largest_hole told in messages, share of the diagonal
/// @throws InvalidInput where the surface encloses no volume, is an open sheet in part, is too large for the limits on
/// time and memory, or where more than 3 % of the result would lie outside of it.
Wrapping wrap_round(const Surface& surface, double largest_hole);

}  // namespace palpate::mesh
