#include "mesh/geometry/surface_tree.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "mesh/errors.h"

namespace palpate::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CornerTriangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, CornerTriangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

enum class Crossing { Through, Touching, Unclear };

Kernel::Point_3 to_cgal(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// Weights of the point of triangle abc that is nearest to p. [Ericson, Real-Time Collision Detection, 5.1.5]
Vec3 nearest_weights(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a;
    const auto along = [](double part, double rest) { return part / (part + rest); };

    // Beyond a corner?
    const double d1 = ab.dot(p - a), d2 = ac.dot(p - a);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    const double d3 = ab.dot(p - b), d4 = ac.dot(p - b);
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    const double d5 = ab.dot(p - c), d6 = ac.dot(p - c);
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};

    // Beyond an edge?
    const double wc = d1 * d4 - d3 * d2, wb = d5 * d2 - d1 * d6, wa = d3 * d6 - d5 * d4;
    if (wc <= 0 && d1 >= 0 && d3 <= 0) {
        const double t = along(d1, -d3);
        return {1 - t, t, 0};
    }
    if (wb <= 0 && d2 >= 0 && d6 <= 0) {
        const double t = along(d2, -d6);
        return {1 - t, 0, t};
    }
    if (wa <= 0 && d4 >= d3 && d5 >= d6) {
        const double t = along(d4 - d3, d5 - d6);
        return {0, 1 - t, t};
    }
    return Vec3(wa, wb, wc) / (wa + wb + wc);
}

/// How the ray from p through q meets a triangle that it is known to intersect, by exact predicates.
Crossing cross(const Kernel::Triangle_3& triangle, const Kernel::Point_3& p, const Kernel::Point_3& q) {
    const auto &a = triangle[0], &b = triangle[1], &c = triangle[2];
    if (CGAL::orientation(a, b, c, p) == CGAL::COPLANAR)
        return CGAL::orientation(a, b, c, q) == CGAL::COPLANAR ? Crossing::Unclear : Crossing::Touching;
    for (int i = 0; i < 3; ++i)
        if (CGAL::orientation(p, q, triangle[i], triangle[i + 1]) == CGAL::COPLANAR) return Crossing::Unclear;
    return Crossing::Through;
}

/// Directions spread over the sphere (Fibonacci lattice), moved by 0.7 and 0.4 so that none runs along an axis, as
/// edges of bodies often do.
Vec3 direction(int i, int count) {
    const double z = 1 - (2 * i + 0.7) / count;
    const double angle = 0.4 + i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double radius = std::sqrt(1 - z * z);
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

}  // namespace

struct SurfaceTree::Impl {
    Surface surface;
    Box box{};
    CornerTriangles triangles;  // those that have an area
    std::vector<int> row_of;    // of the surface, behind each of them
    Tree tree;

    explicit Impl(const Surface& given) : surface(given) {
        for (int t = 0; t < surface.triangles.rows(); ++t) {
            const Kernel::Triangle_3 triangle(corner(t, 0), corner(t, 1), corner(t, 2));
            if (triangle.is_degenerate()) continue;
            triangles.push_back(triangle);
            row_of.push_back(t);
        }
        if (triangles.empty())
            throw InvalidInput(
                "The surface has no triangle with an area: distances to it mean nothing. "
                "Give a surface with at least one proper triangle.");
        box = bounding_box(surface.vertices);

        // Built now, so that queries only read.
        tree.insert(triangles.cbegin(), triangles.cend());
        tree.build();
        tree.accelerate_distance_queries();
    }

    Kernel::Point_3 corner(int triangle, int i) const {
        return to_cgal(surface.vertices.row(surface.triangles(triangle, i)));
    }
};

SurfaceTree::SurfaceTree(const Surface& surface) : impl_(std::make_unique<Impl>(surface)) {}
SurfaceTree::~SurfaceTree() = default;
SurfaceTree::SurfaceTree(SurfaceTree&&) noexcept = default;
SurfaceTree& SurfaceTree::operator=(SurfaceTree&&) noexcept = default;

SurfacePoint SurfaceTree::closest(const Vec3& point) const {
    const auto found = impl_->tree.closest_point_and_primitive(to_cgal(point)).second;
    SurfacePoint result;
    result.triangle = impl_->row_of[static_cast<std::size_t>(found - impl_->triangles.cbegin())];

    const auto corners = impl_->surface.triangles.row(result.triangle);
    const Vec3 a = impl_->surface.vertices.row(corners[0]), b = impl_->surface.vertices.row(corners[1]),
               c = impl_->surface.vertices.row(corners[2]);
    result.barycentric = nearest_weights(point, a, b, c);
    result.position = result.barycentric[0] * a + result.barycentric[1] * b + result.barycentric[2] * c;
    result.distance = (point - result.position).norm();
    return result;
}

bool SurfaceTree::inside(const Vec3& point) const {
    if ((point.array() < impl_->box.min.array()).any() || (point.array() > impl_->box.max.array()).any()) return false;

    // A ray that grazes an edge or a corner counts wrongly: the next direction is tried. An odd count is inside.
    constexpr int attempts = 64;
    const Kernel::Point_3 p = to_cgal(point);
    std::vector<CornerTriangles::const_iterator> hits;
    for (int i = 0; i < attempts; ++i) {
        const Kernel::Point_3 q = to_cgal(point + impl_->box.diagonal() * direction(i, attempts));
        hits.clear();
        impl_->tree.all_intersected_primitives(Kernel::Ray_3(p, q), std::back_inserter(hits));
        bool unclear = false;
        for (const auto& hit : hits) {
            const Crossing crossing = cross(*hit, p, q);
            if (crossing == Crossing::Touching) return true;
            unclear = unclear || crossing == Crossing::Unclear;
        }
        if (!unclear) return hits.size() % 2 == 1;
    }
    return hits.size() % 2 == 1;
}

}  // namespace palpate::mesh
