#include "mesh/core/region.h"

#include <algorithm>
#include <cmath>

#include "mesh/core/convex_hull.h"

namespace palpate::mesh {

namespace {

/// Borders belong to a region even when the point went through single precision, as STL files do: 6e-8 of a
/// coordinate, and a little more for what was computed from it.
double slack(const Vec3& point) { return 2e-7 * point.cwiseAbs().maxCoeff(); }

struct Contains {
    const Vec3& p;

    bool operator()(const BoxRegion& box) const {
        return ((p - box.min).array() >= -slack(p)).all() && ((box.max - p).array() >= -slack(p)).all();
    }
    bool operator()(const SphereRegion& sphere) const { return (p - sphere.center).norm() <= sphere.radius + slack(p); }
    bool operator()(const PlaneRegion& plane) const {
        return std::abs((p - plane.point).dot(plane.normal.normalized())) <= plane.within + slack(p);
    }
    bool operator()(const PointsRegion& near) const {
        if (near.points.rows() == 0) return false;
        const double reach = near.within + slack(p);
        const Eigen::VectorXd squares = (near.points.rowwise() - p.transpose()).rowwise().squaredNorm();
        const double nearest = squares.minCoeff();
        if (nearest <= reach * reach) return true;
        if (!(near.joined > 0 && nearest <= near.joined * near.joined)) return false;
        std::vector<Eigen::Index> neighbours;
        for (Eigen::Index i = 0; i < squares.size(); ++i)
            if (squares[i] <= near.joined * near.joined) neighbours.push_back(i);
        return is_near_hull(near.points(neighbours, Eigen::all), p, reach);
    }
};

}  // namespace

bool contains(const Region& region, const Vec3& point) { return std::visit(Contains{point}, region); }

bool contains(const std::vector<Region>& regions, const Vec3& point) {
    return std::ranges::any_of(regions, [&](const Region& region) { return contains(region, point); });
}

std::vector<char> contains(const std::vector<Region>& regions, const Points& points) {
    std::vector<char> held(static_cast<std::size_t>(points.rows()));
    for (Eigen::Index i = 0; i < points.rows(); ++i)
        held[static_cast<std::size_t>(i)] = contains(regions, Vec3(points.row(i)));
    return held;
}

}  // namespace palpate::mesh
