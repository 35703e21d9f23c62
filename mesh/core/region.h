#pragma once

#include <variant>
#include <vector>

#include "mesh/types.h"

namespace palpate::mesh {

struct BoxRegion {
    Vec3 min, max;  // [mm]
};
struct SphereRegion {
    Vec3 center;
    double radius;  // [mm]
};
/// All points within `within` of the plane, on both sides.
struct PlaneRegion {
    Vec3 point, normal;  // normal: any length but zero
    double within;       // [mm]
};
/// All points within `within` of one of the points, or of the convex hull of those within `joined` of them: what lies
/// between neighbours belongs to the region too.
struct PointsRegion {
    Points points;
    double within;       // [mm]
    double joined = -1;  // [mm]; 0: each point is by itself; below 0: the same, for want of anything said
};

/// A part of space, where a body is held for instance; borders belong to it.
using Region = std::variant<BoxRegion, SphereRegion, PlaneRegion, PointsRegion>;

bool contains(const Region& region, const Vec3& point);

/// In the union of the regions?
bool contains(const std::vector<Region>& regions, const Vec3& point);

/// For each point whether the union holds it (n).
std::vector<char> contains(const std::vector<Region>& regions, const Points& points);

}  // namespace palpate::mesh
