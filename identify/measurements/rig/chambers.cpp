#include "identify/measurements/rig/chambers.h"

#include <fmt/format.h>

#include "identify/measurements/rest_body.h"
#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::identify {
namespace {

/// Does the rest surface show the chamber already? Then what it encloses is no material.
bool is_shown(const mesh::Surface& chamber, const RestBody& body) {
    constexpr int points = 8;  // along each side of its box, at the centres of equal cells
    const mesh::SurfaceTree walls(chamber);
    const mesh::Box box = mesh::bounding_box(chamber.vertices);
    int enclosed = 0, material = 0;
    for (int i = 0; i < points * points * points; ++i) {
        const int row = i / points, layer = row / points;
        const Eigen::Array3d cell = Eigen::Array3i(i % points, row % points, layer).cast<double>();
        const Vec3 point = box.min.array() + (cell + 0.5) / points * box.extent().array();
        if (!walls.inside(point)) continue;
        ++enclosed;
        if (body.holds(point)) ++material;
    }
    return 2 * material < enclosed;
}

void require_inside(const mesh::Surface& chamber, const RestBody& body, const std::string& name) {
    for (Eigen::Index v = 0; v < chamber.vertices.rows(); ++v) {
        const Vec3 vertex = chamber.vertices.row(v);
        if (body.depth(vertex) > 0) continue;
        throw InvalidInput(fmt::format(
            "set.yaml: the chamber of actuator '{}' is no wall of the rest surface, and cannot be carved out of the "
            "body: its vertex {} at {} lies {:.4g} mm outside of the material. Draw it within, in the unit and frame "
            "of the set.",
            name, v, place_in_words(vertex), body.tree.closest(vertex).distance));
    }
}

/// Adds a closed surface as the wall of a cavity, which looks into it.
void add_cavity(const mesh::Surface& chamber, mesh::Surface& body) {
    const Eigen::Index vertices = body.vertices.rows(), triangles = body.triangles.rows();
    body.vertices.conservativeResize(vertices + chamber.vertices.rows(), 3);
    body.vertices.bottomRows(chamber.vertices.rows()) = chamber.vertices;
    body.triangles.conservativeResize(triangles + chamber.triangles.rows(), 3);
    const bool looks_outward = mesh::signed_volume(chamber) > 0;
    for (Eigen::Index t = 0; t < chamber.triangles.rows(); ++t) {
        Eigen::RowVector3i corners = chamber.triangles.row(t).array() + static_cast<int>(vertices);
        if (looks_outward) std::swap(corners[1], corners[2]);
        body.triangles.row(triangles + t) = corners;
    }
}

}  // namespace

void carve_chambers(MeasurementSet& set) {
    for (const mesh::Actuator& actuator : set.actuators) {
        const auto* pressure = std::get_if<mesh::PressureActuator>(&actuator.kind);
        const auto* chamber = pressure ? std::get_if<mesh::Surface>(&pressure->cavity) : nullptr;
        if (!chamber) continue;
        const RestBody body(set.rest_surface);
        if (!body.is_closed || is_shown(*chamber, body)) continue;
        require_inside(*chamber, body, actuator.name);
        add_cavity(*chamber, set.rest_surface);
        set.notes.push_back(fmt::format(
            "The chamber of actuator '{}', {:.4g} mm^3, is not in the rest surface: it is carved out of the body.",
            actuator.name, std::abs(mesh::signed_volume(*chamber))));
    }
}

}  // namespace palpate::identify
