#include "mesh/supports/held_parts.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/numbers/median.h"

namespace palpate::mesh {
namespace {

const char* kind_of(const Region& region) {
    constexpr std::array kinds{"box", "sphere", "plane", "points"};  // in the order of the variant
    return kinds.at(region.index());
}

/// Area of a triangle within the regions, by the centres of pieces that are about `spacing` long; counted for each.
void add_area(const Vec3& a, const Vec3& b, const Vec3& c, const std::vector<Region>& regions, double spacing,
              std::vector<HeldPart>& parts) {
    constexpr int most_cuts = 200;
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::clamp(static_cast<int>(std::ceil(longest / spacing)), 1, most_cuts);
    const double piece = (b - a).cross(c - a).norm() / (2.0 * n * n);
    const auto add = [&](double i, double j) {  // barycentric (i, j) / n
        const Vec3 at = a + i / n * (b - a) + j / n * (c - a);
        for (std::size_t r = 0; r < regions.size(); ++r) parts[r].area += contains(regions[r], at) ? piece : 0;
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n - i; ++j) {
            add(i + 1.0 / 3, j + 1.0 / 3);                     // upright piece
            if (j < n - i - 1) add(i + 2.0 / 3, j + 2.0 / 3);  // its upside-down neighbour
        }
}

double face_area(const VolumeMesh& mesh, Eigen::Index f) {
    const Vec3 a = mesh.nodes.row(mesh.faces(f, 0)), b = mesh.nodes.row(mesh.faces(f, 1)),
               c = mesh.nodes.row(mesh.faces(f, 2));
    return (b - a).cross(c - a).norm() / 2;
}

/// Median length of the elements' first edges [mm].
double edge_of(const VolumeMesh& mesh) {
    std::vector<double> edges(static_cast<std::size_t>(mesh.tetrahedra.rows()));
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto corners = mesh.tetrahedra.row(static_cast<Eigen::Index>(e));
        edges[e] = (mesh.nodes.row(corners[0]) - mesh.nodes.row(corners[1])).norm();
    }
    return upper_median(std::move(edges));
}

bool holds_a_side(const VolumeMesh& mesh, const std::vector<char>& held) {
    const auto of = [&](int node) { return held[static_cast<std::size_t>(node)] != 0; };
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) {
        int corners = 0;
        for (int c = 0; c < 4; ++c) corners += of(mesh.tetrahedra(e, c)) ? 1 : 0;
        if (corners >= 3) return true;
    }
    return false;
}

}  // namespace

std::vector<HeldPart> held_parts(const std::vector<Region>& regions, const Surface& surface, double spacing) {
    std::vector<HeldPart> parts(regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r)
        for (const auto& vertex : surface.vertices.rowwise())
            parts[r].nodes += contains(regions[r], Vec3(vertex.transpose())) ? 1 : 0;
    for (const auto& t : surface.triangles.rowwise())
        add_area(surface.vertices.row(t[0]), surface.vertices.row(t[1]), surface.vertices.row(t[2]), regions, spacing,
                 parts);
    return parts;
}

std::vector<HeldPart> held_parts(const std::vector<Region>& regions, const VolumeMesh& mesh) {
    std::vector<HeldPart> parts(regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const std::vector<char> held = contains(std::vector<Region>{regions[r]}, mesh.nodes);
        parts[r].nodes = std::ranges::count(held, 1);
        for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
            const auto is_held = [&](int c) { return held[static_cast<std::size_t>(mesh.faces(f, c))] != 0; };
            if (is_held(0) && is_held(1) && is_held(2)) parts[r].area += face_area(mesh, f);
        }
    }
    return parts;
}

std::string surface_in_words(double area) {
    return (area < 100 ? fmt::format("{:.3g}", area) : fmt::format("{:.0f}", area)) + " mm^2 of the surface";
}

std::string describe_held_part(const std::vector<Region>& regions, const std::vector<HeldPart>& parts, std::size_t i,
                               const std::string& nodes) {
    return fmt::format("support {} ({}): {} {}, {}", i + 1, kind_of(regions[i]), parts[i].nodes, nodes,
                       surface_in_words(parts[i].area));
}

std::vector<std::string> too_little_held(const std::vector<Region>& regions, const VolumeMesh& mesh) {
    std::vector<std::string> words;
    const std::vector<HeldPart> parts = held_parts(regions, mesh);
    for (std::size_t r = 0; r < regions.size(); ++r)
        if (parts[r].nodes == 0)
            words.push_back(fmt::format(
                "Support {} ({}) holds no node of the mesh. Are its unit and frame those of the body? Enlarge it, or "
                "mesh finer (--edge-length).",
                r + 1, kind_of(regions[r])));
    const std::vector<char> held = contains(regions, mesh.nodes);
    const auto nodes = std::ranges::count(held, 1);
    if (nodes == 0) return words;  // which is refused elsewhere
    if (holds_a_side(mesh, held)) return words;
    words.push_back(fmt::format(
        "The supports hold {} of {} nodes singly, and no element face ({:.3g} mm long): the displacement at such "
        "points depends on the mesh, not on the material. Enlarge the supports ('within' of points), or mesh finer "
        "(--edge-length).",
        nodes, mesh.nodes.rows(), edge_of(mesh)));
    return words;
}

}  // namespace palpate::mesh
