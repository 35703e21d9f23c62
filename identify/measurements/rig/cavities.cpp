#include "identify/measurements/rig/cavities.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "identify/measurements/rest_body.h"
#include "mesh/errors.h"
#include "mesh/topology/check_surface.h"
#include "mesh/topology/weld.h"

namespace palpate::identify {
namespace {

constexpr const char* how_cavities_are_told =
    "Draw the chamber's wall into the rest surface, as a closed shell of its own inside the body, or give the chamber "
    "as 'cavity: {surface: FILE}'.";

/// 0 inside of the closed surface.
double distance_to(const mesh::Surface& surface, const Vec3& point) {
    const mesh::SurfaceTree tree(surface);
    return tree.inside(point) ? 0 : tree.closest(point).distance;
}

/// The part of a surface that is nearest to the point must be closed.
void check_nearest_part(const mesh::Surface& welded, const Vec3& point, const std::string& what) {
    const std::vector<mesh::Surface> parts = mesh::split_parts(welded);
    const auto nearest = std::ranges::min_element(
        parts, {}, [&](const mesh::Surface& part) { return mesh::SurfaceTree(part).closest(point).distance; });
    const int open = mesh::check_surface(*nearest).boundary_edges;
    if (open > 0)
        throw InvalidInput(
            fmt::format("{}: the wall nearest to {} is open: {} of its edges belong to one triangle alone, and what is "
                        "open holds no pressure. Close it ('palpate check' shows where it is open).",
                        what, place_in_words(point), open));
}

std::vector<mesh::Shell> cavities_of(const mesh::Surface& welded) {
    std::vector<mesh::Shell> shells = mesh::find_shells(welded);
    std::erase_if(shells, [](const mesh::Shell& shell) { return !shell.is_cavity(); });
    return shells;
}

}  // namespace

mesh::Shell nearest_cavity(const mesh::Surface& rest, const Vec3& point, const std::string& what) {
    const RestBody body(rest);
    const mesh::Surface welded = mesh::weld(rest, 1e-6 * body.box.diagonal()).surface;
    check_nearest_part(welded, point, what);
    const std::vector<mesh::Shell> cavities = cavities_of(welded);
    if (cavities.empty()) {
        const bool in_a_hollow = body.is_closed && !body.tree.inside(point) &&
                                 (point.array() >= body.box.min.array()).all() &&
                                 (point.array() <= body.box.max.array()).all();
        throw InvalidInput(fmt::format(
            "{}: there is no closed cavity near {}: {}. {}", what, place_in_words(point),
            in_a_hollow ? "the hollow there is open to the outside" : "the rest surface has no shell inside",
            how_cavities_are_told));
    }
    const auto nearest = std::ranges::min_element(
        cavities, {}, [&](const mesh::Shell& shell) { return distance_to(shell.surface, point); });
    const double distance = distance_to(nearest->surface, point), allowed = 0.05 * body.box.longest_side();
    if (distance > allowed)
        throw InvalidInput(
            fmt::format("{}: the nearest closed cavity is {:.4g} mm from {}, {:.4g} mm are allowed. Give a point in "
                        "the chamber, in the unit and frame of the set. {}",
                        what, distance, place_in_words(point), allowed, how_cavities_are_told));
    return *nearest;
}

}  // namespace palpate::identify
