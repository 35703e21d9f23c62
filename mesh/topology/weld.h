#pragma once

#include "mesh/core/surface.h"

namespace palpate::mesh {

struct WeldResult {
    Surface surface;  // vertices in the order of their first use; those of no triangle are gone
    int merged = 0;   // used vertices that became one with another
};

/// Vertices within `distance` [mm] of an earlier one become that one; triangles stay, in their order.
WeldResult weld(const Surface& surface, double distance);

}  // namespace palpate::mesh
