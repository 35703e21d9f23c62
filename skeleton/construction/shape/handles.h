#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "skeleton/construction/shape/tet_graph.h"

namespace palpate::skeleton {

/// Homology class of paths through a body's tetrahedra: which handles (holes) they encircle.
///
/// A bit for each handle: XOR of the crossings of all faces that a closed way passes. Zero if it can be drawn together
/// to a point, else which handles it goes round (an odd number of times). The bits are a basis of the first cohomology
/// of the body over the field of two elements.
struct Handles {
    int count = 0;
    std::vector<std::array<std::uint64_t, 4>> crossing;  // of the face opposite to each corner (m); outer faces: 0
};

/// Those of the whole body; of more than 64 some are not seen.
Handles find_handles(const TetGraph& graph);

}  // namespace palpate::skeleton
