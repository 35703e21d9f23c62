#include "mesh/geometry/winding.h"

#include <Eigen/Geometry>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "mesh/geometry/surface_tree.h"

namespace palpate::mesh {
namespace {

/// Solid angle of a triangle seen from the origin. [Van Oosterom & Strackee 1983]
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

std::vector<Vec3> points_inside(const Surface& closed, int count) {
    const SurfaceTree tree(closed);
    const Box box = bounding_box(closed.vertices);
    std::mt19937_64 random(1);
    std::uniform_real_distribution<> uniform(0, 1);
    std::vector<Vec3> points;
    while (static_cast<int>(points.size()) < count) {
        const Vec3 at(uniform(random), uniform(random), uniform(random));
        const Vec3 point = box.min + at.cwiseProduct(box.extent());
        if (tree.inside(point)) points.push_back(point);
    }
    return points;
}

}  // namespace

double winding_number(const Surface& surface, const Vec3& point) {
    double sum = 0;
    for (const auto& t : surface.triangles.rowwise()) {
        const auto corner = [&](int i) -> Vec3 { return surface.vertices.row(t[i]).transpose() - point; };
        sum += solid_angle(corner(0), corner(1), corner(2));
    }
    return sum / (4 * std::numbers::pi);
}

double share_outside(const Surface& closed, const Surface& surface, int points) {
    const std::vector<Vec3> inside = points_inside(closed, points);
    const auto count = [&](const tbb::blocked_range<std::size_t>& range, int outside) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            outside += std::abs(winding_number(surface, inside[i])) < 0.5 ? 1 : 0;
        return outside;
    };
    const int outside =
        tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, inside.size()), 0, count, std::plus<>());
    return static_cast<double>(outside) / points;
}

}  // namespace palpate::mesh
