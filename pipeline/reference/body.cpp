#include "pipeline/reference/body.h"

#include <fmt/format.h>

#include "mesh/errors.h"
#include "mesh/remesh.h"
#include "mesh/repair_surface.h"
#include "mesh/tetrahedralise.h"

namespace palpate::pipeline {

Body make_body(const mesh::Surface& surface, const BodyOptions& options, const Progress& progress) {
    Body body;
    report(progress, "repairing the surface", 0.0);
    const mesh::RepairResult repaired = mesh::repair_surface(surface);
    body.repaired = repaired.surface;
    body.notes = repaired.steps;

    const double longest = mesh::bounding_box(repaired.surface.vertices).longest_side();
    const double edge = options.edge_length > 0 ? options.edge_length : default_edge_share * longest;
    if (edge > 0.5 * longest) {
        throw InvalidInput(
            fmt::format("edge length {:g} mm is more than half the body's longest side ({:g} mm): choose "
                        "a smaller one, 6 % of it is usual",
                        edge, longest));
    }
    report(progress, "remeshing the surface", 0.3);
    body.surface = mesh::remesh(repaired.surface, {.edge_length = edge, .volume_change = options.volume_change});
    report(progress, "filling with tetrahedra", 0.6);
    const mesh::VolumeMesh linear = mesh::tetrahedralise(body.surface, {.edge_length = edge});
    body.volume = options.linear_elements ? linear : mesh::to_quadratic(linear);
    report(progress, "filling with tetrahedra", 1.0);
    return body;
}

mesh::BoxRegion default_clamp(const mesh::Box& box) {
    Eigen::Index axis = 0;
    const double longest = box.extent().maxCoeff(&axis);
    const Vec3 margin = Vec3::Constant(0.01 * longest);
    mesh::BoxRegion clamp{box.min - margin, box.max + margin};
    clamp.max[axis] = box.min[axis] + 0.05 * longest;
    return clamp;
}

}  // namespace palpate::pipeline
