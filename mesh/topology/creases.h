#pragma once

#include <array>
#include <vector>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// The lines of a surface that remeshing must keep.
struct Creases {
    std::vector<std::array<int, 2>> edges;  // vertex indices, the smaller first, in rising order
    std::vector<int> corners;               // vertices where such lines end, branch or bend, in rising order
};

/// Edges whose faces turn by `angle` [degrees] or more, and the borders of broad flat faces, where a body is cut
/// or clamped.
/// @pre no edge has more than two triangles.
Creases find_creases(const Surface& surface, double angle);

}  // namespace palpate::mesh
