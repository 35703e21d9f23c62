#include "mesh/topology/check_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "mesh/errors.h"
#include "mesh/system/isolated.h"
#include "mesh/topology/self_intersections.h"
#include "mesh/topology/shells.h"
#include "mesh/topology/weld.h"

namespace palpate::mesh {

/// What a check comes to.
struct Findings {
    SurfaceReport report;
    std::vector<FaultPlace> places;
};

template <class Archive>
void serialize(Archive& archive, FaultPlace& place) {
    archive(place.fault, place.at, place.triangles);
}

template <class Archive>
void serialize(Archive& archive, Findings& found) {
    SurfaceReport& r = found.report;
    archive(r.vertices, r.triangles, r.duplicate_vertices, r.degenerate_triangles, r.duplicate_triangles,
            r.boundary_edges, r.holes, r.non_manifold_edges, r.non_manifold_vertices, r.inconsistent_edges,
            r.self_intersections, r.components, r.closed, r.outward, r.volume, r.area, r.box.min, r.box.max,
            found.places);
}

namespace {

constexpr double weld_distance = 1e-6;  // share of the diagonal

struct EdgeUse {
    int forward = 0, backward = 0;  // triangles that run along it from the smaller vertex to the larger, and back
    std::vector<int> triangles;
};

/// The triangles that a body may be made of; which rows they were; and, where somebody asks, where faults are.
struct Proper {
    Surface surface;
    std::vector<int> rows;
    std::vector<FaultPlace>* places;

    void note(Fault fault, const Vec3& at, std::vector<int> triangles) const {
        if (!places) return;
        for (int& t : triangles) t = rows[static_cast<std::size_t>(t)];
        places->push_back({fault, at, std::move(triangles)});
    }
};

Vec3 center_of(const Surface& surface, int t) {
    return surface.vertices(surface.triangles.row(t).transpose().eval(), Eigen::all).colwise().mean();
}

/// The triangles less those without area and less twins.
Proper proper_triangles(const Surface& surface, SurfaceReport& report, std::vector<FaultPlace>* places) {
    std::vector<char> keep(static_cast<std::size_t>(surface.triangles.rows()), 1);
    for (const int t : degenerate_triangles(surface)) {
        keep[static_cast<std::size_t>(t)] = 0;
        ++report.degenerate_triangles;
        if (places) places->push_back({Fault::degenerate_triangle, center_of(surface, t), {t}});
    }
    std::set<std::array<int, 3>> known;
    Proper proper{{surface.vertices, surface.triangles}, {}, places};
    Triangles& kept = proper.surface.triangles;
    Eigen::Index count = 0;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
        std::array<int, 3> key{surface.triangles(t, 0), surface.triangles(t, 1), surface.triangles(t, 2)};
        std::sort(key.begin(), key.end());
        if (!keep[static_cast<std::size_t>(t)]) continue;
        if (known.insert(key).second) {
            kept.row(count++) = surface.triangles.row(t);
            proper.rows.push_back(static_cast<int>(t));
            continue;
        }
        ++report.duplicate_triangles;
        if (places)
            places->push_back(
                {Fault::duplicate_triangle, center_of(surface, static_cast<int>(t)), {static_cast<int>(t)}});
    }
    kept.conservativeResize(count, 3);
    return proper;
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

void check_edges(const Proper& proper, SurfaceReport& report) {
    const Surface& surface = proper.surface;
    std::map<std::pair<int, int>, EdgeUse> edges;
    for (int t = 0; t < surface.triangles.rows(); ++t)
        for (int i = 0; i < 3; ++i) {
            const int a = surface.triangles(t, i), b = surface.triangles(t, (i + 1) % 3);
            EdgeUse& use = edges[std::minmax(a, b)];
            ++(a < b ? use.forward : use.backward);
            if (proper.places) use.triangles.push_back(t);
        }
    std::vector<std::pair<int, int>> border;
    for (const auto& [edge, use] : edges) {
        const int total = use.forward + use.backward;
        const bool is_border = total == 1, is_crowded = total > 2, is_torn = total == 2 && use.forward != 1;
        if (is_border) border.push_back(edge);
        report.non_manifold_edges += is_crowded;
        report.inconsistent_edges += is_torn;
        if (is_border || is_crowded || is_torn)
            proper.note(is_border    ? Fault::hole
                        : is_crowded ? Fault::non_manifold_edge
                                     : Fault::inconsistent_edge,
                        (surface.vertices.row(edge.first) + surface.vertices.row(edge.second)) / 2, use.triangles);
    }
    report.boundary_edges = static_cast<int>(border.size());
    report.holes = count_loops(border);
    report.closed = surface.triangles.rows() > 0 && border.empty() && report.non_manifold_edges == 0;
}

/// Vertices whose triangles are not one fan: of the edges across from the vertex, each touches the next.
int count_non_manifold_vertices(const Proper& proper) {
    const Surface& surface = proper.surface;
    std::vector<std::vector<std::pair<int, int>>> rim(static_cast<std::size_t>(surface.vertices.rows()));
    for (const auto& t : surface.triangles.rowwise())
        for (int i = 0; i < 3; ++i) rim[static_cast<std::size_t>(t[i])].emplace_back(t[(i + 1) % 3], t[(i + 2) % 3]);
    int count = 0;
    for (std::size_t v = 0; v < rim.size(); ++v) {
        if (count_loops(rim[v]) < 2) continue;
        ++count;
        proper.note(Fault::non_manifold_vertex, surface.vertices.row(static_cast<Eigen::Index>(v)), {});
    }
    return count;
}

int count_self_intersections(const Proper& proper) {
    const auto pairs = self_intersections(proper.surface);
    for (const auto& [a, b] : pairs)
        proper.note(Fault::self_intersection, (center_of(proper.surface, a) + center_of(proper.surface, b)) / 2,
                    {a, b});
    return static_cast<int>(pairs.size());
}

/// Bodies must be turned outwards, cavities inwards.
bool is_outward(const Surface& surface, const SurfaceReport& report) {
    if (!(report.volume > 0)) return false;
    if (!report.closed || report.components == 1 || report.self_intersections > 0) return true;
    const std::vector<Shell> shells = find_shells(surface);
    return std::all_of(shells.begin(), shells.end(),
                       [](const Shell& shell) { return shell.is_cavity() ? shell.volume < 0 : shell.volume > 0; });
}

SurfaceReport count_faults(const Surface& surface, std::vector<FaultPlace>* places) {
    SurfaceReport report;
    report.box = bounding_box(surface.vertices);
    const WeldResult welded = weld(surface, weld_distance * report.box.diagonal());
    report.vertices = static_cast<int>(welded.surface.vertices.rows());
    report.triangles = static_cast<int>(welded.surface.triangles.rows());
    report.duplicate_vertices = welded.merged;

    const Proper proper = proper_triangles(welded.surface, report, places);
    check_edges(proper, report);
    report.non_manifold_vertices = count_non_manifold_vertices(proper);
    const std::vector<int> parts = connected_parts(proper.surface);
    report.components = parts.empty() ? 0 : *std::max_element(parts.begin(), parts.end()) + 1;
    report.self_intersections = count_self_intersections(proper);
    report.area = area(proper.surface);
    report.volume = signed_volume(proper.surface);
    report.outward = is_outward(proper.surface, report);
    if (places) std::ranges::stable_sort(*places, {}, [](const FaultPlace& place) { return place.fault; });
    return report;
}

}  // namespace

bool SurfaceReport::sound() const {
    return closed && outward && degenerate_triangles == 0 && duplicate_triangles == 0 && inconsistent_edges == 0 &&
           non_manifold_vertices == 0 && self_intersections == 0;
}

const char* name_of(Fault fault) {
    constexpr std::array names{"",
                               "triangle without area",
                               "triangle that stands there twice",
                               "edge with more than two triangles",
                               "edge whose triangles disagree about the outside",
                               "open edge of a hole",
                               "vertex in which parts of the surface touch",
                               "pair of triangles that cross"};
    return names[static_cast<std::size_t>(fault)];
}

SurfaceReport check_surface(const Surface& surface, std::vector<FaultPlace>* places) {
    if (surface.triangles.rows() == 0) return {};
    Findings found = isolated_as<Findings>("The check of the surface", "Remesh or simplify it in a mesh editor first.",
                                           limits_for(static_cast<double>(surface.triangles.rows()), 1e-3), [&] {
                                               Findings in_child;
                                               in_child.report =
                                                   count_faults(surface, places ? &in_child.places : nullptr);
                                               return in_child;
                                           });
    if (places) *places = std::move(found.places);
    return found.report;
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
