#include "mesh/meshing/smooth/bulges.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>

#include "mesh/topology/creases.h"

namespace palpate::mesh {
namespace {

constexpr double largest_bulge = 0.15;  // of the chord; an arc of 67 degrees has it: what turns by more is no arc
constexpr double tip_share = 0.75;      // of the crease angle; facets that turn more from their mean stand round a tip

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

std::array<int, 2> ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// A surface's edges and the triangles at them.
struct Edges {
    std::vector<std::array<int, 2>> ends;
    std::vector<std::array<int, 3>> of_triangle;
    std::vector<std::vector<int>> triangles;
};

Edges edges_of(const Surface& surface) {
    Edges edges;
    for (const auto& t : surface.triangles.rowwise())
        for (int i = 0; i < 3; ++i) edges.ends.push_back(ordered(t[i], t[(i + 1) % 3]));
    std::ranges::sort(edges.ends);
    edges.ends.erase(std::unique(edges.ends.begin(), edges.ends.end()), edges.ends.end());

    edges.triangles.resize(edges.ends.size());
    edges.of_triangle.resize(static_cast<std::size_t>(surface.triangles.rows()));
    for (int t = 0; t < surface.triangles.rows(); ++t)
        for (int i = 0; i < 3; ++i) {
            const auto edge = ordered(surface.triangles(t, i), surface.triangles(t, (i + 1) % 3));
            const auto number = std::ranges::lower_bound(edges.ends, edge) - edges.ends.begin();
            edges.of_triangle[t][i] = static_cast<int>(number);
            edges.triangles[number].push_back(t);
        }
    return edges;
}

std::vector<int> crease_edges(const Surface& surface, const Edges& edges, double crease_angle) {
    const std::vector<std::array<int, 2>> sharp = find_creases(surface, crease_angle).edges;
    std::vector<int> creases;
    for (std::size_t e = 0; e < edges.ends.size(); ++e)
        if (edges.triangles[e].size() != 2 || std::ranges::binary_search(sharp, edges.ends[e]))
            creases.push_back(static_cast<int>(e));
    return creases;
}

/// Unit normals at the corners of triangles: the facets' mean, by angle [Thurmer & Wuthrich 1998], over those that
/// lie round the vertex without a crease between. None (zero) at a tip, where a normal means nothing.
class CornerNormals {
public:
    CornerNormals(const Surface& surface, const Edges& edges, const std::vector<int>& creases, double crease_angle)
        : surface_(surface), group_(static_cast<std::size_t>(surface.triangles.size())) {
        std::iota(group_.begin(), group_.end(), 0);
        for (int e = 0; e < std::ssize(edges.ends); ++e) {
            if (std::ranges::binary_search(creases, e)) continue;
            for (const int vertex : edges.ends[e])
                unite(corner(edges.triangles[e][0], vertex), corner(edges.triangles[e][1], vertex));
        }
        average(std::cos(tip_share * radians(crease_angle)));
    }

    Vec3 at(int triangle, int vertex) const { return normals_.row(root(corner(triangle, vertex))).transpose(); }

private:
    int corner(int triangle, int vertex) const {
        int i = 0;
        while (surface_.triangles(triangle, i) != vertex) ++i;
        return 3 * triangle + i;
    }
    int root(int corner) const {
        while (group_[corner] != corner) corner = group_[corner];
        return corner;
    }
    void unite(int a, int b) {
        const int first = root(a), second = root(b);
        group_[std::max(first, second)] = std::min(first, second);
    }

    void average(double least_cosine) {
        Points facets = area_vectors(surface_);
        for (auto facet : facets.rowwise()) facet.normalize();  // without an area: zero, has no say
        normals_ = Points::Zero(surface_.triangles.size(), 3);
        for (int t = 0; t < surface_.triangles.rows(); ++t)
            for (int i = 0; i < 3; ++i) {
                const Vec3 at = surface_.vertices.row(surface_.triangles(t, i));
                const Vec3 a = surface_.vertices.row(surface_.triangles(t, (i + 1) % 3)).transpose() - at;
                const Vec3 b = surface_.vertices.row(surface_.triangles(t, (i + 2) % 3)).transpose() - at;
                normals_.row(root(3 * t + i)) += std::atan2(a.cross(b).norm(), a.dot(b)) * facets.row(t);
            }
        for (auto normal : normals_.rowwise()) normal.normalize();

        std::vector<int> tips;
        for (int c = 0; c < normals_.rows(); ++c)
            if (!facets.row(c / 3).isZero(0) && facets.row(c / 3).dot(normals_.row(root(c))) < least_cosine)
                tips.push_back(root(c));
        for (const int tip : tips) normals_.row(tip).setZero();
    }

    const Surface& surface_;
    std::vector<int> group_;  // of each corner of each triangle: another corner of its group, or itself
    Points normals_;          // of each group, at its root
};

/// Middle of an arc over the chord d with unit normals na, nb at its ends, off the chord's middle.
///
/// Hermite's cubic with the end tangents d - (d.n) n has -((d.na) na - (d.nb) nb)/8 [cf. Vlachos et al. 2001]: on an
/// arc of angle a this is |d| sin(a)/8, where the arc has |d| tan(a/4)/2. With h = cos(a/2) = |na + nb|/2 their ratio
/// is h (1 + h)/2.
Vec3 middle_by_normals(const Vec3& d, const Vec3& na, const Vec3& nb) {
    const double h = (na + nb).norm() / 2;
    if (na.isZero(0) || nb.isZero(0) || h == 0) return Vec3::Zero();
    return -(d.dot(na) * na - d.dot(nb) * nb) / (4 * h * (1 + h));
}

/// The same with unit tangents: |d| (ta - tb)/8 is |d| sin(a/2)/4 on an arc, too small by (1 + h)/2.
Vec3 middle_by_tangents(const Vec3& d, const Vec3& ta, const Vec3& tb) {
    return d.norm() * (ta - tb) / (4 + 2 * (ta + tb).norm());
}

/// Unit tangents of the crease lines at their vertices: of the circle through the vertex and its two neighbours.
/// None where lines end, branch, or bend by the crease angle.
std::map<int, Vec3> crease_tangents(const Surface& surface, const Edges& edges, const std::vector<int>& creases,
                                    double crease_angle) {
    std::map<int, std::vector<int>> along;
    for (const int e : creases) {
        along[edges.ends[e][0]].push_back(edges.ends[e][1]);
        along[edges.ends[e][1]].push_back(edges.ends[e][0]);
    }
    std::map<int, Vec3> tangents;
    for (const auto& [v, neighbours] : along) {
        if (neighbours.size() != 2) continue;
        const Vec3 back = surface.vertices.row(v) - surface.vertices.row(neighbours[0]);
        const Vec3 ahead = surface.vertices.row(neighbours[1]) - surface.vertices.row(v);
        if (back.normalized().dot(ahead.normalized()) <= std::cos(radians(crease_angle))) continue;
        tangents[v] = (back / back.squaredNorm() + ahead / ahead.squaredNorm()).normalized();
    }
    return tangents;
}

Vec3 limited(const Vec3& middle, const Vec3& d) {
    const double most = largest_bulge * d.norm();
    return middle.norm() > most ? Vec3(middle * (most / middle.norm())) : middle;
}

}  // namespace

Bulges bulges_of(const Surface& surface, double crease_angle) {
    const Edges edges = edges_of(surface);
    Bulges result{edges.ends, edges.of_triangle, Points(std::ssize(edges.ends), 3),
                  crease_edges(surface, edges, crease_angle)};
    const CornerNormals normals(surface, edges, result.creases, crease_angle);
    const std::map<int, Vec3> tangents = crease_tangents(surface, edges, result.creases, crease_angle);

    for (int e = 0; e < std::ssize(edges.ends); ++e) {
        const auto [a, b] = edges.ends[e];
        const Vec3 d = surface.vertices.row(b) - surface.vertices.row(a);
        const auto tangent = [&](int vertex) -> Vec3 {
            const auto found = tangents.find(vertex);
            if (found == tangents.end()) return d.normalized();
            return found->second.dot(d) < 0 ? Vec3(-found->second) : found->second;
        };
        const int t = edges.triangles[e][0];
        const Vec3 middle = std::ranges::binary_search(result.creases, e)
                                ? middle_by_tangents(d, tangent(a), tangent(b))
                                : middle_by_normals(d, normals.at(t, a), normals.at(t, b));
        result.middles.row(e) = limited(middle, d).transpose();
    }
    return result;
}

}  // namespace palpate::mesh
