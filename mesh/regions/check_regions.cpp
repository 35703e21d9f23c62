#include "mesh/regions/check_regions.h"

#include <fmt/format.h>

#include <cmath>

#include "mesh/errors.h"
#include "mesh/geometry/winding.h"
#include "mesh/topology/check_surface.h"
#include "mesh/topology/self_intersections.h"

namespace palpate::mesh {
namespace {

std::string at_words(const Vec3& at) { return fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", at.x(), at.y(), at.z()); }

void check_sound(const MaterialRegion& region, const std::string& where) {
    const SurfaceReport report = check_surface(region.surface);
    if (report.sound()) return;
    throw InvalidInput(
        fmt::format("{}: the surface of region '{}' bounds no body: {} Mend it; 'palpate check' shows "
                    "its faults.",
                    where, region.name, fmt::join(describe_faults(report), " ")));
}

/// What is smaller changes nothing that could be measured, and would take most of the elements.
void check_size(const MaterialRegion& region, const Surface& body, const std::string& where) {
    constexpr double least = 0.01;  // of the body's longest side
    const double allowed = least * bounding_box(body.vertices).longest_side();
    const double side = std::cbrt(std::abs(signed_volume(region.surface)));
    if (side >= allowed) return;
    throw InvalidInput(
        fmt::format("{}: region '{}' is as large as a cube of {:.3g} mm; at least {:.3g} mm, 1 % of the body's longest "
                    "side, is allowed, as less cannot be told from the rest. Is it in the body's unit? Else take it "
                    "out.",
                    where, region.name, side, allowed));
}

void check_inside(const MaterialRegion& region, const Surface& body, const std::string& where) {
    if (const std::vector<Vec3> meeting = meeting_places(region.surface, body); !meeting.empty())
        throw InvalidInput(
            fmt::format("{}: the surface of region '{}' crosses or touches that of the body, near {} first. A region "
                        "has to lie inside the body: end it short of the surface, within a support too, where the gap "
                        "changes nothing.",
                        where, region.name, at_words(meeting.front())));
    const Vec3 vertex = region.surface.vertices.row(0);
    constexpr double half_in = 0.5;
    if (winding_number(body, vertex) < half_in)
        throw InvalidInput(
            fmt::format("{}: region '{}' lies outside of the body's material, as its vertex at {} does. Are the unit "
                        "and the frame those of the body?",
                        where, region.name, at_words(vertex)));
}

}  // namespace

std::vector<Vec3> meeting_places(const Surface& one, const Surface& other) {
    const auto first = static_cast<int>(one.triangles.rows());
    const auto offset = static_cast<int>(one.vertices.rows());
    Surface both{Points(one.vertices.rows() + other.vertices.rows(), 3),
                 Triangles(one.triangles.rows() + other.triangles.rows(), 3)};
    both.vertices << one.vertices, other.vertices;
    both.triangles.topRows(first) = one.triangles;
    both.triangles.bottomRows(other.triangles.rows()) = other.triangles.array() + offset;
    std::vector<Vec3> places;
    for (const auto& [a, b] : self_intersections(both)) {
        if ((a < first) == (b < first)) continue;
        places.emplace_back(both.vertices(both.triangles.row(a < first ? a : b), Eigen::all).colwise().mean());
    }
    return places;
}

void check_regions(const std::vector<MaterialRegion>& regions, const Surface& body, const std::string& where) {
    for (const MaterialRegion& region : regions) {
        check_sound(region, where);
        check_size(region, body, where);
        check_inside(region, body, where);
    }
    for (std::size_t a = 0; a < regions.size(); ++a) {
        for (std::size_t b = a + 1; b < regions.size(); ++b) {
            const std::vector<Vec3> meeting = meeting_places(regions[a].surface, regions[b].surface);
            if (meeting.empty()) continue;
            throw InvalidInput(
                fmt::format("{}: the surfaces of regions '{}' and '{}' cross or touch, near {} first. Regions may lie "
                            "apart, or one within another: move one of the surfaces, or give what they share to one.",
                            where, regions[a].name, regions[b].name, at_words(meeting.front())));
        }
    }
}

}  // namespace palpate::mesh
