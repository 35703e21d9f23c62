#include "identify/measurements/rig/chambers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "identify/measurements/rest_body.h"
#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/topology/shells.h"

namespace palpate::identify {
namespace {

void check_chamber(const mesh::Surface& chamber, const RestBody& body, const std::string& name) {
    const mesh::Box box = mesh::bounding_box(chamber.vertices);
    const double allowed = 0.05 * body.box.longest_side();
    if ((box.min.array() >= body.box.min.array() - allowed).all() &&
        (box.max.array() <= body.box.max.array() + allowed).all())
        return;
    throw InvalidInput(fmt::format(
        "set.yaml: the chamber of actuator '{}' reaches from [{:.4g}] to [{:.4g}] mm, out of the body, which reaches "
        "from [{:.4g}] to [{:.4g}] mm. Are unit and frame of both files the same?",
        name, fmt::join(box.min, ", "), fmt::join(box.max, ", "), fmt::join(body.box.min, ", "),
        fmt::join(body.box.max, ", ")));
}

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

}  // namespace

void carve_chambers(MeasurementSet& set) {
    for (const mesh::Actuator& actuator : set.actuators) {
        const auto* pressure = std::get_if<mesh::PressureActuator>(&actuator.kind);
        const auto* chamber = pressure ? std::get_if<mesh::Surface>(&pressure->cavity) : nullptr;
        if (!chamber) continue;
        const RestBody body(set.rest_surface);
        check_chamber(*chamber, body, actuator.name);
        if (!body.is_closed || is_shown(*chamber, body)) continue;
        require_inside(*chamber, body, actuator.name);
        set.rest_surface = mesh::with_cavity(std::move(set.rest_surface), *chamber);
        set.notes.push_back(fmt::format(
            "The chamber of actuator '{}', {:.4g} mm^3, is not in the rest surface: it is carved out of the body.",
            actuator.name, std::abs(mesh::signed_volume(*chamber))));
    }
}

}  // namespace palpate::identify
