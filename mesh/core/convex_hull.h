#pragma once

#include "mesh/types.h"

namespace palpate::mesh {

/// Does the convex hull of the corners come within `reach` of the point?
///
/// The hull's nearest point is approached by going towards the corner that lies furthest against the way left [Gilbert
/// 1966]; the search ends as soon as the answer is certain. Where it is not after a thousand steps, it is no.
/// @pre there is a corner, and reach > 0 for an answer of yes in general.
bool is_near_hull(const Points& corners, const Vec3& point, double reach);

}  // namespace palpate::mesh
