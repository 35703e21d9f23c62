#pragma once

#include <array>
#include <vector>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// A surface whose triangles bulge quadratically between its vertices: each edge has a middle off its chord.
/// At barycentric l a triangle lies 4 (l0 l1 b01 + l1 l2 b12 + l2 l0 b20) off its facet; flat faces do not bulge.
struct Bulges {
    std::vector<std::array<int, 2>> edges;        // vertex indices, the smaller first, in rising order
    std::vector<std::array<int, 3>> of_triangle;  // its edges between corners (0,1), (1,2), (2,0)
    Points middles;                               // b of each edge, from the middle of its chord [mm]
    std::vector<int> creases;                     // the edges that stay sharp, in rising order
};

/// The bulges of a surface by the normals at its vertices, along creases by the tangents; both are exact on circles.
/// @param crease_angle edges that turn by more [degrees], borders of broad flat faces and edges that have not two
/// triangles are creases: normals on either side know nothing of each other.
Bulges bulges_of(const Surface& surface, double crease_angle);

}  // namespace palpate::mesh
