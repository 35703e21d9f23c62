#include "mesh/meshing/smooth_surface.h"

#include <fmt/core.h>

#include "mesh/errors.h"
#include "mesh/geometry/closest_within.h"
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

namespace {

/// Nodes at the border of what is held do not leave it.
void keep_within(const std::vector<Region>& held, const Points& nodes, Points& moves) {
    const std::vector<Region> regions = with_borders(held);
    if (regions.empty()) return;
    for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
        const Vec3 straight = nodes.row(n), curved = nodes.row(n) + moves.row(n);
        if (contains(regions, straight) && !contains(regions, curved))
            moves.row(n) = closest_within(regions, curved) - straight;
    }
}

}  // namespace

VolumeMesh curve_to(const VolumeMesh& body, const Surface& surface, const SmoothSurfaceOptions& options) {
    options.validate();
    if (!body.is_quadratic()) return body;
    const Bulges bulges = bulges_of(surface, options.crease_angle);
    const Points moves = moves_onto(body, surface, bulges, options.crease_angle);
    if (moves.isZero(0)) return body;
    Points all = follow_boundary(body, moves);
    keep_within(options.held, body.nodes, all);
    return move_nodes(body, all);
}

}  // namespace palpate::mesh
