#pragma once

#include "mesh/core/surface.h"

namespace palpate::mesh {

struct RemeshOptions {
    double edge_length = 0;    // target [mm]; 0: 0.06 of the longest side
    double crease_angle = 60;  // edges sharper than this are kept [degrees], (0, 180)
    int iterations = 5;
    double volume_change = 0.01;  // allowed, as a share of the volume, (0, 0.2]; chords of a round body cut volume off
    void validate() const;
};

/// Isotropic triangles that keep sharp edges; short of the target length where the surface is thin or curved.
/// @pre the surface is closed, outward, free of self-intersections. The result is too.
/// @throws SolverFailure when no sound remeshing was found.
Surface remesh(const Surface& surface, const RemeshOptions& options = {});

}  // namespace palpate::mesh
