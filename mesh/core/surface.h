#pragma once

#include "mesh/types.h"

namespace palpate::mesh {

/// A triangulated surface [mm].
struct Surface {
    Points vertices;      // (n x 3)
    Triangles triangles;  // (m x 3)
};

struct Box {
    Vec3 min, max;
    Vec3 extent() const { return max - min; }
    double longest_side() const { return extent().maxCoeff(); }
    double diagonal() const { return extent().norm(); }
};

Box bounding_box(const Points& points);

/// Enclosed volume [mm^3]: sum of signed tetrahedra to the origin; positive when faces look outward.
double signed_volume(const Surface& surface);

/// Total area [mm^2].
double area(const Surface& surface);

/// Area vectors of the triangles, length = area, outward (m x 3) [mm^2].
Points area_vectors(const Surface& surface);

/// Unit vertex normals, weighted by angle (n x 3). [Thurmer & Wuthrich 1998]
Points vertex_normals(const Surface& surface);

/// Which way the surface looks near a point: unit mean normal of the triangles whose centre lies within `radius` [mm],
/// else that of the one with the nearest centre. @pre there are triangles.
Vec3 mean_normal(const Surface& surface, const Vec3& point, double radius);

/// An axis-aligned box as 12 triangles, each side cut into n(x,y,z) quads; for samples and tests.
Surface make_box(const Vec3& min, const Vec3& max, const Eigen::Vector3i& quads);

/// A sphere: an icosahedron subdivided `levels` times; for samples and tests.
Surface make_sphere(const Vec3& center, double radius, int levels);

}  // namespace palpate::mesh
