#include "mesh/meshing/smooth/onto_surface.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "mesh/geometry/surface_tree.h"
#include "mesh/topology/creases.h"

namespace palpate::mesh {
namespace {

constexpr double round_off = 1e-12;    // of the box's diagonal: moves that say nothing
constexpr double along_crease = 0.15;  // of an edge's length: its nodes lie no further from a crease that it follows

/// The place above a point of the surface.
Vec3 above(const SurfacePoint& point, const Bulges& bulges) {
    Vec3 place = point.position;
    for (int i = 0; i < 3; ++i) {
        const double weight = 4 * point.barycentric[i] * point.barycentric[(i + 1) % 3];
        place += weight * bulges.middles.row(bulges.of_triangle[point.triangle][i]).transpose();
    }
    return place;
}

/// The nearest point of a crease.
struct CreasePoint {
    Vec3 place = Vec3::Zero();  // on the bulging edge
    double distance = std::numeric_limits<double>::infinity();
};

CreasePoint nearest_crease(const Vec3& point, const Surface& surface, const Bulges& bulges) {
    CreasePoint nearest;
    for (const int e : bulges.creases) {
        const Vec3 a = surface.vertices.row(bulges.edges[e][0]);
        const Vec3 d = surface.vertices.row(bulges.edges[e][1]).transpose() - a;
        if (d.isZero(0)) continue;
        const double share = std::clamp(d.dot(point - a) / d.squaredNorm(), 0.0, 1.0);
        const double distance = (a + share * d - point).norm();
        if (distance >= nearest.distance) continue;
        nearest = {a + share * d + 4 * share * (1 - share) * bulges.middles.row(e).transpose(), distance};
    }
    return nearest;
}

/// Places of the nodes along the body's creases. A chord of a cylinder's rim lies on its cap: the nearest point of
/// the surface would leave it there.
std::map<int, Vec3> places_on_creases(const VolumeMesh& body, const Surface& surface, const Bulges& bulges,
                                      double crease_angle) {
    const auto sharp = find_creases({body.nodes, body.faces.leftCols<3>()}, crease_angle).edges;
    std::map<int, Vec3> places;
    for (const auto& face : body.faces.rowwise())
        for (int i = 0; i < 3; ++i) {
            const std::array<int, 3> nodes{face[i], face[(i + 1) % 3], face[3 + i]};
            if (!std::ranges::binary_search(sharp,
                                            std::array{std::min(nodes[0], nodes[1]), std::max(nodes[0], nodes[1])}))
                continue;
            const double length = (body.nodes.row(nodes[0]) - body.nodes.row(nodes[1])).norm();
            std::array<CreasePoint, 3> points;
            for (int k = 0; k < 3; ++k)
                points[k] = nearest_crease(body.nodes.row(nodes[k]).transpose(), surface, bulges);
            if (std::ranges::max(points, {}, &CreasePoint::distance).distance > along_crease * length) continue;
            for (int k = 0; k < 3; ++k) places[nodes[k]] = points[k].place;
        }
    return places;
}

}  // namespace

Points moves_onto(const VolumeMesh& body, const Surface& surface, const Bulges& bulges, double crease_angle) {
    Eigen::VectorXi nodes;
    const Points normals = vertex_normals(boundary_surface(body, &nodes));
    const Points facets = area_vectors(surface);
    const SurfaceTree tree(surface);

    Points moves = Points::Zero(body.nodes.rows(), 3);
    for (Eigen::Index i = 0; i < nodes.size(); ++i) {
        const Vec3 node = body.nodes.row(nodes[i]);
        const SurfacePoint nearest = tree.closest(node);
        if (facets.row(nearest.triangle).dot(normals.row(i)) > 0)
            moves.row(nodes[i]) = (above(nearest, bulges) - node).transpose();
    }
    for (const auto& [node, place] : places_on_creases(body, surface, bulges, crease_angle))
        moves.row(node) = place.transpose() - body.nodes.row(node);

    // What is flat stays flat to the last digit.
    const double least = round_off * bounding_box(body.nodes).diagonal();
    for (auto move : moves.rowwise())
        if (move.norm() < least) move.setZero();
    return moves;
}

}  // namespace palpate::mesh
