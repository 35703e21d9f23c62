#pragma once

#include <vector>

#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

struct TetrahedraliseOptions {
    double edge_length = 0;      // of the largest elements [mm]; 0: the mean edge of the surface
    double quality = 1.3;        // largest ratio of circumradius to shortest edge, [1.1, 3]
    double time_limit = 120;     // [s]
    double memory_limit = 8192;  // [MiB]
    void validate() const;
};

/// Fills a closed surface with linear tetrahedra by TetGen; closed inner shells become cavities.
///
/// TetGen runs in a child process with limits on time and memory, for it crashes and hangs on bad surfaces; what
/// it returns is checked (elements, volume against the surface, least quality).
/// @throws SolverFailure when it crashed, hung or returned nonsense: the message says which and what to do.
VolumeMesh tetrahedralise(const Surface& surface, const TetrahedraliseOptions& options = {});

/// The same with elements that end at closed surfaces inside, the interfaces of materials: none lies on both sides.
/// @pre the interfaces meet neither the surface nor each other.
VolumeMesh tetrahedralise_within(const Surface& surface, const std::vector<Surface>& interfaces,
                                 const TetrahedraliseOptions& options = {});

}  // namespace palpate::mesh
