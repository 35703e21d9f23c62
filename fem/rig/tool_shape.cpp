#include "fem/rig/tool_shape.h"

#include <fmt/format.h>

#include "fem/rig/round_shapes.h"
#include "fem/rig/surface_distance.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

double checked_radius(const mesh::Tool& tool, double radius) {
    if (radius > 0 && std::isfinite(radius)) return radius;
    throw InvalidInput(
        fmt::format("The tool \"{}\" has a radius of {:g} mm; allowed: more than 0.", tool.name, radius));
}

}  // namespace

std::shared_ptr<const RigidShape> tool_shape(const mesh::Tool& tool) {
    if (const auto* sphere = std::get_if<mesh::SphereShape>(&tool.shape))
        return ball_shape(tool.origin, checked_radius(tool, sphere->radius));
    if (const auto* punch = std::get_if<mesh::FlatShape>(&tool.shape)) {
        checked_radius(tool, punch->radius);
        if (punch->axis.norm() == 0)
            throw InvalidInput(
                fmt::format("The axis of the flat punch \"{}\" is (0, 0, 0): give the direction that it "
                            "presses along, of any length.",
                            tool.name));
        return punch_shape(tool.origin, *punch);
    }
    if (const auto* solid = std::get_if<mesh::SurfaceShape>(&tool.shape))
        return std::make_shared<SurfaceDistance>(tool.name, solid->surface);
    return nullptr;
}

}  // namespace palpate::fem
