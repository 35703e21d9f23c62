#pragma once

#include "mesh/core/volume_mesh.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::fem {

/// A point of a boundary face.
struct FacePoint {
    int face = -1;
    Vec3 l = Vec3::Zero();         // barycentric coordinates in the face
    Vec3 position = Vec3::Zero();  // on the facets that the search sees [mm]
    double distance = 0;           // from the point asked for [mm]
};

/// Finds the boundary point nearest to some point. Quadratic faces are searched as four flat triangles each.
class NearestFace {
public:
    explicit NearestFace(const mesh::VolumeMesh& mesh);

    /// Safe from several threads.
    FacePoint closest(const Vec3& point) const;

private:
    int triangles_per_face_;
    mesh::SurfaceTree tree_;
};

}  // namespace palpate::fem
