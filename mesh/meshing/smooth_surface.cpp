#include "mesh/meshing/smooth_surface.h"

#include <fmt/core.h>

#include "mesh/errors.h"
#include "mesh/meshing/smooth/bulges.h"
#include "mesh/meshing/smooth/follow_boundary.h"
#include "mesh/meshing/smooth/move_nodes.h"
#include "mesh/meshing/smooth/onto_surface.h"

namespace palpate::mesh {

void SmoothSurfaceOptions::validate() const {
    if (!(crease_angle > 0 && crease_angle < 180))
        throw InvalidInput(
            fmt::format("Smoothing the surface: crease_angle is {} degrees; more than 0 and less than 180 is allowed.",
                        crease_angle));
}

VolumeMesh curve_to(const VolumeMesh& body, const Surface& surface, const SmoothSurfaceOptions& options) {
    options.validate();
    if (!body.is_quadratic()) return body;
    const Bulges bulges = bulges_of(surface, options.crease_angle);
    const Points moves = moves_onto(body, surface, bulges, options.crease_angle);
    if (moves.isZero(0)) return body;
    return move_nodes(body, follow_boundary(body, moves));
}

}  // namespace palpate::mesh
