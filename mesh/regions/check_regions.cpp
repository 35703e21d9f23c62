#include "mesh/regions/check_regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"
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

constexpr double least_region = 0.01;  // of the body's longest side: what is smaller changes nothing that is measured

void check_size(const MaterialRegion& region, double least_side, const std::string& where) {
    const double side = std::cbrt(std::abs(signed_volume(region.surface)));
    if (side >= least_side) return;
    throw InvalidInput(
        fmt::format("{}: region '{}' is as large as a cube of {:.3g} mm; at least {:.3g} mm, 1 % of the body's longest "
                    "side, is allowed, as less cannot be told from the rest. Is it in the body's unit? Else take it "
                    "out.",
                    where, region.name, side, least_side));
}

/// How far the vertices of a surface lie inside and outside of another one [mm].
struct Reach {
    double in = 0, out = 0;
    Vec3 furthest_out = Vec3::Zero();
};

Reach reach_of(const Surface& surface, const SurfaceTree& other) {
    Reach reach;
    for (const auto& vertex : surface.vertices.rowwise()) {
        const Vec3 at = vertex.transpose();
        const double distance = other.closest(at).distance;
        if (other.inside(at)) {
            reach.in = std::max(reach.in, distance);
        } else if (distance > reach.out) {
            reach.out = distance;
            reach.furthest_out = at;
        }
    }
    return reach;
}

/// What counts as touching [mm]: two meshes of one interface differ by their chords, and numbers in files are rounded.
double touching(const MaterialRegion& region, double least_side) {
    constexpr double share = 0.2;  // of a small region's side
    return std::min(least_side, share * std::cbrt(std::abs(signed_volume(region.surface))));
}

void check_inside(const MaterialRegion& region, const SurfaceTree& body, double touch, const std::string& where) {
    const Reach reach = reach_of(region.surface, body);
    if (reach.out <= touch) return;
    if (reach.in <= touch)
        throw InvalidInput(
            fmt::format("{}: region '{}' lies outside of the body's material, as its vertex at {} does. Are the unit "
                        "and the frame those of the body?",
                        where, region.name, at_words(reach.furthest_out)));
    throw InvalidInput(
        fmt::format("{}: region '{}' reaches {:.3g} mm out of the body at {}; {:.2g} mm is allowed, as touching its "
                    "surface. Cut the region off there.",
                    where, region.name, reach.out, at_words(reach.furthest_out), touch));
}

void check_apart(const MaterialRegion& a, const MaterialRegion& b, double touch, const std::string& where) {
    const std::vector<Vec3> meeting = meeting_places(a.surface, b.surface);
    if (meeting.empty()) return;
    const Reach first = reach_of(a.surface, SurfaceTree(b.surface)),
                second = reach_of(b.surface, SurfaceTree(a.surface));
    const auto is_both = [&](const Reach& reach) { return reach.in > touch && reach.out > touch; };
    const auto is_neither = [&](const Reach& reach) { return reach.in <= touch && reach.out <= touch; };
    if (is_neither(first) && is_neither(second))
        throw InvalidInput(fmt::format("{}: regions '{}' and '{}' are the same part of the body. Take one of them out.",
                                       where, a.name, b.name));
    if (!is_both(first) && !is_both(second)) return;
    throw InvalidInput(
        fmt::format("{}: regions '{}' and '{}' overlap, near {} first. Regions may lie apart, side by side, or one "
                    "within another: move one of the surfaces, or give what they share to one.",
                    where, a.name, b.name, at_words(meeting.front())));
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

bool lies_within(const Surface& one, const Surface& other) {
    constexpr double share = 0.2;  // of its side: a core whose surface is that of a hole in the other lies beside it
    const Reach reach = reach_of(one, SurfaceTree(other));
    const double touch = share * std::cbrt(std::abs(signed_volume(one)));
    return reach.in > touch && reach.out <= touch;
}

void check_regions(const std::vector<MaterialRegion>& regions, const Surface& body, const std::string& where) {
    if (regions.empty()) return;
    const double least_side = least_region * bounding_box(body.vertices).longest_side();
    const SurfaceTree tree(body);
    for (const MaterialRegion& region : regions) {
        check_size(region, least_side, where);
        if (region.label) continue;  // a part of the body's own elements or voxels
        check_sound(region, where);
        check_inside(region, tree, touching(region, least_side), where);
    }
    for (std::size_t a = 0; a < regions.size(); ++a) {
        for (std::size_t b = a + 1; b < regions.size(); ++b) {
            if (regions[a].label && regions[b].label) continue;
            check_apart(regions[a], regions[b],
                        std::min(touching(regions[a], least_side), touching(regions[b], least_side)), where);
        }
    }
}

}  // namespace palpate::mesh
