#include "mesh/geometry/closest_within.h"

#include <algorithm>
#include <cassert>
#include <optional>

namespace palpate::mesh {

namespace {

struct Closest {
    const Vec3& p;

    std::optional<Vec3> operator()(const BoxRegion& box) const { return p.cwiseMax(box.min).cwiseMin(box.max); }
    std::optional<Vec3> operator()(const SphereRegion& sphere) const {
        const Vec3 out = p - sphere.center;
        return out.norm() > sphere.radius ? sphere.center + sphere.radius * out.normalized() : p;
    }
    std::optional<Vec3> operator()(const PlaneRegion& plane) const {
        const Vec3 normal = plane.normal.normalized();
        const double above = (p - plane.point).dot(normal);
        return p + (std::clamp(above, -plane.within, plane.within) - above) * normal;
    }
    std::optional<Vec3> operator()(const PointsRegion& /*unknown*/) const { return std::nullopt; }
};

}  // namespace

std::vector<Region> with_borders(const std::vector<Region>& regions) {
    std::vector<Region> known = regions;
    std::erase_if(known, [](const Region& region) { return std::holds_alternative<PointsRegion>(region); });
    return known;
}

Vec3 closest_within(const std::vector<Region>& regions, const Vec3& point) {
    std::optional<Vec3> closest;
    for (const Region& region : regions) {
        const std::optional<Vec3> found = std::visit(Closest{point}, region);
        if (found && (!closest || (*found - point).norm() < (*closest - point).norm())) closest = found;
    }
    assert(closest);
    return *closest;
}

}  // namespace palpate::mesh
