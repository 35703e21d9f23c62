#include "mesh/topology/self_intersections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>

namespace palpate::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box3 = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;

class Crossings {
public:
    explicit Crossings(const Surface& surface) : surface_(surface) {}

    Point at(int vertex) const {
        return {surface_.vertices(vertex, 0), surface_.vertices(vertex, 1), surface_.vertices(vertex, 2)};
    }
    std::array<int, 3> corners(int t) const {
        return {surface_.triangles(t, 0), surface_.triangles(t, 1), surface_.triangles(t, 2)};
    }
    Kernel::Triangle_3 triangle(int t) const {
        const auto [a, b, c] = corners(t);
        return {at(a), at(b), at(c)};
    }

    bool cross(int s, int t) const {
        // Corners of s, those shared with t first; then t's own corner that is left.
        std::array<int, 3> p = corners(s), q = corners(t);
        const auto shared_by = [](const std::array<int, 3>& other) {
            return [&other](int v) { return std::find(other.begin(), other.end(), v) != other.end(); };
        };
        const auto p_own = std::stable_partition(p.begin(), p.end(), shared_by(corners(t)));
        std::stable_partition(q.begin(), q.end(), shared_by(corners(s)));
        switch (p_own - p.begin()) {
            case 0:
                return CGAL::do_intersect(triangle(s), triangle(t));
            case 1:  // the side across from the shared corner of one must meet the other
                return CGAL::do_intersect(Kernel::Segment_3(at(p[1]), at(p[2])), triangle(t)) ||
                       CGAL::do_intersect(Kernel::Segment_3(at(q[1]), at(q[2])), triangle(s));
            case 2:  // folded flat onto each other
                return CGAL::coplanar(at(p[0]), at(p[1]), at(p[2]), at(q[2])) &&
                       CGAL::coplanar_orientation(at(p[0]), at(p[1]), at(p[2]), at(q[2])) == CGAL::POSITIVE;
            default:
                return false;
        }
    }

private:
    const Surface& surface_;
};

}  // namespace

std::vector<int> degenerate_triangles(const Surface& surface) {
    const Crossings of(surface);
    std::vector<int> found;
    for (int t = 0; t < surface.triangles.rows(); ++t)
        if (of.triangle(t).is_degenerate()) found.push_back(t);
    return found;
}

std::vector<std::pair<int, int>> self_intersections(const Surface& surface) {
    const Crossings of(surface);
    std::vector<Box3> boxes;
    for (int t = 0; t < surface.triangles.rows(); ++t)
        if (const auto triangle = of.triangle(t); !triangle.is_degenerate()) boxes.emplace_back(triangle.bbox(), t);

    std::vector<std::pair<int, int>> pairs;
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box3& a, const Box3& b) {
        const auto [s, t] = std::minmax({a.info(), b.info()});
        if (of.cross(s, t)) pairs.emplace_back(s, t);
    });
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

}  // namespace palpate::mesh
