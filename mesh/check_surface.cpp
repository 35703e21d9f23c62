#include "mesh/check_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "mesh/topology/self_intersections.h"
#include "mesh/topology/shells.h"
#include "mesh/topology/weld.h"

namespace palpate::mesh {
namespace {

constexpr double weld_distance = 1e-6;  // share of the diagonal

struct EdgeUse {
    int forward = 0, backward = 0;  // triangles that run along it from the smaller vertex to the larger, and back
};

/// The triangles less those without area and less twins.
Surface proper_triangles(const Surface& surface, SurfaceReport& report) {
    std::vector<char> keep(static_cast<std::size_t>(surface.triangles.rows()), 1);
    for (const int t : degenerate_triangles(surface)) {
        keep[static_cast<std::size_t>(t)] = 0;
        ++report.degenerate_triangles;
    }
    std::set<std::array<int, 3>> known;
    Surface result{surface.vertices, surface.triangles};
    Eigen::Index count = 0;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
        std::array<int, 3> key{surface.triangles(t, 0), surface.triangles(t, 1), surface.triangles(t, 2)};
        std::sort(key.begin(), key.end());
        if (!keep[static_cast<std::size_t>(t)]) continue;
        if (known.insert(key).second)
            result.triangles.row(count++) = surface.triangles.row(t);
        else
            ++report.duplicate_triangles;
    }
    result.triangles.conservativeResize(count, 3);
    return result;
}

/// How many loops or chains the edges make, counted as parts that hang together.
int count_loops(const std::vector<std::pair<int, int>>& edges) {
    std::map<int, int> leader;
    const auto find = [&](int v) {
        while (leader.at(v) != v) v = leader.at(v);
        return v;
    };
    int loops = 0;
    for (const auto& [a, b] : edges) {
        for (const int v : {a, b}) loops += leader.try_emplace(v, v).second;
        const int p = find(a), q = find(b);
        loops -= p != q;
        leader[std::max(p, q)] = std::min(p, q);
    }
    return loops;
}

void check_edges(const Surface& surface, SurfaceReport& report) {
    std::map<std::pair<int, int>, EdgeUse> edges;
    for (const auto& t : surface.triangles.rowwise())
        for (int i = 0; i < 3; ++i) {
            const int a = t[i], b = t[(i + 1) % 3];
            ++(a < b ? edges[{a, b}].forward : edges[{b, a}].backward);
        }
    std::vector<std::pair<int, int>> border;
    for (const auto& [edge, use] : edges) {
        const int total = use.forward + use.backward;
        if (total == 1) border.push_back(edge);
        report.non_manifold_edges += total > 2;
        report.inconsistent_edges += total == 2 && use.forward != 1;
    }
    report.boundary_edges = static_cast<int>(border.size());
    report.holes = count_loops(border);
    report.closed = surface.triangles.rows() > 0 && border.empty() && report.non_manifold_edges == 0;
}

/// Vertices whose triangles are not one fan: of the edges across from the vertex, each touches the next.
int count_non_manifold_vertices(const Surface& surface) {
    std::vector<std::vector<std::pair<int, int>>> rim(static_cast<std::size_t>(surface.vertices.rows()));
    for (const auto& t : surface.triangles.rowwise())
        for (int i = 0; i < 3; ++i) rim[static_cast<std::size_t>(t[i])].emplace_back(t[(i + 1) % 3], t[(i + 2) % 3]);
    int count = 0;
    for (const auto& edges : rim) count += count_loops(edges) > 1;
    return count;
}

/// Bodies must be turned outwards, cavities inwards.
bool is_outward(const Surface& surface, const SurfaceReport& report) {
    if (!(report.volume > 0)) return false;
    if (!report.closed || report.components == 1 || report.self_intersections > 0) return true;
    const std::vector<Shell> shells = find_shells(surface);
    return std::all_of(shells.begin(), shells.end(),
                       [](const Shell& shell) { return shell.is_cavity() ? shell.volume < 0 : shell.volume > 0; });
}

}  // namespace

bool SurfaceReport::sound() const {
    return closed && outward && degenerate_triangles == 0 && duplicate_triangles == 0 && inconsistent_edges == 0 &&
           non_manifold_vertices == 0 && self_intersections == 0;
}

SurfaceReport check_surface(const Surface& surface) {
    SurfaceReport report;
    if (surface.triangles.rows() == 0) return report;
    report.box = bounding_box(surface.vertices);
    const WeldResult welded = weld(surface, weld_distance * report.box.diagonal());
    report.vertices = static_cast<int>(welded.surface.vertices.rows());
    report.triangles = static_cast<int>(welded.surface.triangles.rows());
    report.duplicate_vertices = welded.merged;

    const Surface proper = proper_triangles(welded.surface, report);
    check_edges(proper, report);
    report.non_manifold_vertices = count_non_manifold_vertices(proper);
    const std::vector<int> parts = connected_parts(proper);
    report.components = parts.empty() ? 0 : *std::max_element(parts.begin(), parts.end()) + 1;
    report.self_intersections = static_cast<int>(self_intersections(proper).size());
    report.area = area(proper);
    report.volume = signed_volume(proper);
    report.outward = is_outward(proper, report);
    return report;
}

std::vector<std::string> describe_faults(const SurfaceReport& report) {
    std::vector<std::string> faults;
    const auto add = [&](int count, const char* what, const char* repair) {
        if (count > 0) faults.push_back(fmt::format("{} {}: {}.", count, what, repair));
    };
    if (report.triangles == 0) faults.emplace_back("No triangles: repair can do nothing, give a surface.");
    add(report.degenerate_triangles, "triangle(s) without area", "repair drops or flips them");
    add(report.duplicate_triangles, "triangle(s) that stand there twice", "repair keeps one of each");
    add(report.non_manifold_edges, "edge(s) with more than two triangles",
        "repair takes the sheets apart, or wraps the body");
    add(report.non_manifold_vertices, "vertex(es) in which parts of the surface touch",
        "repair takes them apart, or wraps the body");
    add(report.inconsistent_edges, "edge(s) whose triangles disagree about the outside", "repair turns the triangles");
    if (report.boundary_edges > 0)
        faults.push_back(
            fmt::format("{} hole(s) with {} open edges: repair fills those that are small against the body.",
                        report.holes, report.boundary_edges));
    add(report.self_intersections, "pair(s) of triangles that cross",
        "repair cuts them out and fills the gaps, or wraps the body");
    if (report.closed && !report.outward)
        faults.push_back(
            fmt::format("The surface is closed but turned inside out (signed volume {:.4g} mm^3): repair turns it.",
                        report.volume));
    return faults;
}

}  // namespace palpate::mesh
