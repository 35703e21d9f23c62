#pragma once

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// How often a surface, open or crossing itself as it may be, goes round a point: 1 inside of a closed outward one, 0
/// outside, something between near a hole. [Jacobson, Kavan & Sorkine-Hornung 2013; Van Oosterom & Strackee 1983]
double winding_number(const Surface& surface, const Vec3& point);

/// The share of what `closed` encloses that lies outside of `surface`, by `points` points drawn at random, always the
/// same; its standard deviation is below 0.5 / sqrt(points). @pre `closed` encloses a volume.
double share_outside(const Surface& closed, const Surface& surface, int points);

}  // namespace palpate::mesh
