#pragma once

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// Closes holes whose border lies in a plane, within 0.5 % of the surface's diagonal, and whose box has a diagonal of
/// `largest` [mm] or less: a missing side of a CAD body, the cut end of a vessel. Borders that meet themselves are
/// left.
/// @pre neighbouring triangles agree about the outside.
Surface cap_flat_holes(const Surface& surface, double largest);

}  // namespace palpate::mesh
