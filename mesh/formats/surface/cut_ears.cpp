#include <Eigen/Geometry>

#include <limits>
#include <numeric>

#include "mesh/formats/surface/polygons.h"

namespace palpate::mesh {
namespace {

using Flat = Eigen::Vector2d;

/// Twice the signed area of abc.
double turn(const Flat& a, const Flat& b, const Flat& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// The corners in the plane of the polygon's area vector [Newell], counter-clockwise.
std::vector<Flat> flatten(const std::vector<Vec3>& corners) {
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        normal += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
    const Vec3 u = normal.unitOrthogonal(), v = normal.normalized().cross(u);
    std::vector<Flat> flat;
    flat.reserve(corners.size());
    for (const Vec3& corner : corners) flat.emplace_back(u.dot(corner - corners[0]), v.dot(corner - corners[0]));
    return flat;
}

/// The corners that do not stand out: only they can lie in an ear, and cutting ears makes none.
std::vector<int> reflex_corners(const std::vector<Flat>& flat) {
    std::vector<int> reflex;
    const std::size_t n = flat.size();
    for (std::size_t i = 0; i < n; ++i)
        if (turn(flat[(i + n - 1) % n], flat[i], flat[(i + 1) % n]) <= 0) reflex.push_back(static_cast<int>(i));
    return reflex;
}

/// Is b a convex corner, with no reflex corner of what is left in the triangle abc?
bool is_ear(const std::vector<Flat>& flat, const std::vector<int>& reflex, int a, int b, int c) {
    const auto at = [&](int i) { return flat[static_cast<std::size_t>(i)]; };
    if (turn(at(a), at(b), at(c)) <= 0) return false;
    for (const int p : reflex) {
        if (p == a || p == b || p == c || at(p) == at(a) || at(p) == at(c)) continue;
        if (turn(at(a), at(b), at(p)) >= 0 && turn(at(b), at(c), at(p)) >= 0 && turn(at(c), at(a), at(p)) >= 0)
            return false;
    }
    return true;
}

}  // namespace

std::vector<int> cut_ears(const std::vector<Vec3>& corners) {
    const std::vector<Flat> flat = flatten(corners);
    std::vector<int> left(corners.size()), reflex = reflex_corners(flat), triangles;
    std::iota(left.begin(), left.end(), 0);

    // The ear with the shortest cut goes first; in long polygons the first one found, for the sake of time.
    constexpr std::size_t long_polygon = 64;
    while (left.size() > 3) {
        std::size_t best = 0;
        double shortest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < left.size(); ++i) {
            const int a = left[(i + left.size() - 1) % left.size()], b = left[i], c = left[(i + 1) % left.size()];
            const double length = (corners[static_cast<std::size_t>(a)] - corners[static_cast<std::size_t>(c)]).norm();
            if (length >= shortest || !is_ear(flat, reflex, a, b, c)) continue;
            shortest = length;
            best = i;
            if (left.size() > long_polygon) break;
        }
        // A polygon that crosses itself may have no ear: any corner will do, repair looks after the rest.
        triangles.insert(triangles.end(),
                         {left[(best + left.size() - 1) % left.size()], left[best], left[(best + 1) % left.size()]});
        std::erase(reflex, left[best]);
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    }
    triangles.insert(triangles.end(), left.begin(), left.end());
    return triangles;
}

}  // namespace palpate::mesh
