#pragma once

#include "identify/recordings/assembly/frames/rigid_motion.h"
#include "mesh/core/surface.h"

namespace palpate::identify {

struct SurfaceFitOptions {
    double stand_off = 0;    // of the points over the surface [mm]
    bool near_only = false;  // the recording's frame is nearly the mesh's: no search for where to begin
};

/// From points that lie on the surface and tell nothing else, as of a scan or of markers without names.
///
/// Begins where the principal axes of points and surface agree, in their 24 ways, and at 72 turns spread evenly
/// [Alexa, CVPR (2022): super-Fibonacci]; from each, some steps of Gauss and Newton on the distances along the normal
/// to the nearest surface points [Chen, Medioni 1992]; the best eight to the end. Distances beyond three times their
/// median count for as much as that.
///
/// The uncertainty is from the Hessian at the end; a turn or a shift along which the surface moves into itself has
/// none, and a note names it. A second pose that fits nearly as well is told, and the mirrored points, where these fit
/// better.
/// @pre at least six points
Registration fit_surface(const Points& recorded, const mesh::Surface& surface, const SurfaceFitOptions& options = {});

}  // namespace palpate::identify
