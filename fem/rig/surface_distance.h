#pragma once

#include <array>
#include <string>
#include <vector>

#include "fem/rig/rigid_shape.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::fem {

/// Signed distance to a closed triangulated surface. The side is told by the normal of what is nearest, a face, an edge
/// or a corner, the last by the angles of the faces that meet there [Baerentzen & Aanaes 2005].
class SurfaceDistance final : public RigidShape {
public:
    /// `name`: for messages. @throws InvalidInput where the surface is empty or not closed.
    SurfaceDistance(const std::string& name, const mesh::Surface& surface);
    using RigidShape::gap;
    Gap gap(const Vec3& y) const override;
    double radius() const override { return radius_; }

private:
    mesh::Surface surface_;
    mesh::SurfaceTree tree_;
    Points face_normals_, corner_normals_;
    std::vector<std::array<int, 3>> beyond_;  // the triangle across each edge, opposite to the corner of that number
    double radius_;
};

}  // namespace palpate::fem
