#include "mesh/core/convex_hull.h"

#include <algorithm>

namespace palpate::mesh {

bool is_near_hull(const Points& corners, const Vec3& point, double reach) {
    constexpr int most_steps = 1000;
    const Points around = corners.rowwise() - point.transpose();
    Vec3 v = around.colwise().mean();  // of the hull, seen from the point
    for (int step = 0; step < most_steps; ++step) {
        const double length = v.norm();
        if (length <= reach) return true;
        Eigen::Index furthest = 0;
        const double support = (around * v).minCoeff(&furthest);
        // the hull lies beyond the plane <x, v> = support
        if (support > reach * length) return false;
        const Vec3 direction = around.row(furthest).transpose() - v;
        const double squared = direction.squaredNorm();
        const double fall = -direction.dot(v);  // half of what |v|^2 falls by at first
        if (!(fall > 1e-14 * length * length) || squared == 0) return false;
        v += std::min(1.0, fall / squared) * direction;
    }
    return false;
}

}  // namespace palpate::mesh
