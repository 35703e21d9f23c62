#include "mesh/topology/creases.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <queue>

namespace palpate::mesh {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// Edge -> its one or two triangles (-1: none).
using EdgeTriangles = std::map<std::array<int, 2>, std::array<int, 2>>;

EdgeTriangles edge_triangles_of(const Surface& surface) {
    EdgeTriangles edges;
    for (int t = 0; t < surface.triangles.rows(); ++t)
        for (int i = 0; i < 3; ++i) {
            const int a = surface.triangles(t, i), b = surface.triangles(t, (i + 1) % 3);
            const auto [edge, is_new] = edges.try_emplace({std::min(a, b), std::max(a, b)}, std::array{t, -1});
            if (!is_new) edge->second[1] = t;
        }
    return edges;
}

// What counts as a broad flat face: a choice between creases lost round small faces and facets of round bodies that are
// taken for faces.
constexpr double one_plane = 0.5 * degree;  // between normals: more than files round off
constexpr std::size_t least_triangles = 8;
constexpr double least_part = 0.01;       // of the whole area
constexpr double least_roundness = 0.03;  // area over perimeter squared, 0.08 of a disc: 0.03 of a strip of 1 : 6

/// Flat faces that are broad, and rounder than the facets of a cylinder. For each triangle the number of its flat face,
/// or -1.
std::vector<int> flat_faces(const Surface& surface, const Points& normals, const EdgeTriangles& edges) {
    const Eigen::Index m = surface.triangles.rows();
    std::vector<std::array<int, 3>> neighbours(static_cast<std::size_t>(m), {-1, -1, -1});
    for (const auto& [edge, pair] : edges) {
        for (int side = 0; side < 2; ++side) {
            if (pair[1] < 0) continue;
            auto& list = neighbours[static_cast<std::size_t>(pair[side])];
            *std::find(list.begin(), list.end(), -1) = pair[1 - side];
        }
    }
    const Eigen::VectorXd areas = area_vectors(surface).rowwise().norm();
    std::vector<int> by_area(static_cast<std::size_t>(m));
    std::iota(by_area.begin(), by_area.end(), 0);
    std::stable_sort(by_area.begin(), by_area.end(), [&](int a, int b) { return areas[a] > areas[b]; });

    std::vector<int> face(static_cast<std::size_t>(m), -1);
    std::vector<char> seen(static_cast<std::size_t>(m), 0);
    int count = 0;
    for (const int seed : by_area) {
        if (seen[static_cast<std::size_t>(seed)]) continue;
        std::vector<int> members{seed};
        seen[static_cast<std::size_t>(seed)] = 1;
        double total = 0, perimeter = 0;
        for (std::size_t k = 0; k < members.size(); ++k) {
            total += areas[members[k]];
            for (const int next : neighbours[static_cast<std::size_t>(members[k])]) {
                if (next < 0 || seen[static_cast<std::size_t>(next)]) continue;
                if (normals.row(seed).dot(normals.row(next)) < std::cos(one_plane)) continue;
                seen[static_cast<std::size_t>(next)] = 1;
                members.push_back(next);
            }
        }
        if (members.size() < least_triangles || total < least_part * areas.sum()) continue;
        for (const int t : members) face[static_cast<std::size_t>(t)] = count;
        for (const auto& [edge, pair] : edges) {
            const bool first = face[static_cast<std::size_t>(pair[0])] == count;
            const bool second = pair[1] >= 0 && face[static_cast<std::size_t>(pair[1])] == count;
            if (first != second) perimeter += (surface.vertices.row(edge[0]) - surface.vertices.row(edge[1])).norm();
        }
        if (total < least_roundness * perimeter * perimeter) {
            for (const int t : members) face[static_cast<std::size_t>(t)] = -1;
            continue;
        }
        ++count;
    }
    return face;
}

/// Vertices where the lines end, branch, or bend by more than 30 degrees.
std::vector<int> corners_of(const Surface& surface, const std::vector<std::array<int, 2>>& lines) {
    std::map<int, std::vector<int>> along;
    for (const auto& [a, b] : lines) {
        along[a].push_back(b);
        along[b].push_back(a);
    }
    std::vector<int> corners;
    for (const auto& [v, ends] : along) {
        bool corner = ends.size() != 2;
        if (!corner) {
            const Vec3 into = (surface.vertices.row(v) - surface.vertices.row(ends[0])).normalized();
            const Vec3 out = (surface.vertices.row(ends[1]) - surface.vertices.row(v)).normalized();
            corner = into.dot(out) < std::cos(30 * degree);
        }
        if (corner) corners.push_back(v);
    }
    return corners;
}

}  // namespace

Creases find_creases(const Surface& surface, double angle) {
    const Points normals = area_vectors(surface).rowwise().normalized();
    const EdgeTriangles edges = edge_triangles_of(surface);
    const std::vector<int> face = flat_faces(surface, normals, edges);

    Creases creases;
    for (const auto& [edge, pair] : edges) {
        const bool border = pair[1] < 0;
        const double turn = border ? -1 : normals.row(pair[0]).dot(normals.row(pair[1]));
        const bool flat_border = !border &&
                                 face[static_cast<std::size_t>(pair[0])] != face[static_cast<std::size_t>(pair[1])] &&
                                 turn < std::cos(5 * degree);
        if (border || turn <= std::cos(angle * degree) || flat_border) creases.edges.push_back(edge);
    }
    creases.corners = corners_of(surface, creases.edges);
    return creases;
}

}  // namespace palpate::mesh
