#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mesh/core/region.h"
#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::skeleton {

/// A body to place spheres in: its surface [mm], closed and outward, and what is known about it.
struct Shape {
    std::string name;
    mesh::Surface surface;
    int handles = 0;              // of the body: independent loops that nothing fills
    int tips = -1;                // free ends of limbs; -1: no limbs
    bool thin = false;            // of limbs and plates all over
    Mat3 mirrors = Mat3::Zero();  // normals of planes of symmetry, in its columns; zero: none
};

/// Bar, plate, sheet, cube, ellipsoid, torus, double torus, tee, wye, hollow ball; about 100 mm long.
std::vector<Shape> all_shapes();
Shape shape(const std::string& name);

/// The zero level of a function that is negative inside, by marching tetrahedra on cells of `step` [mm], its vertices
/// on the level itself. @pre the level lies inside the box.
mesh::Surface level_surface(const std::function<double(const Vec3&)>& f, const mesh::Box& box, double step);

/// A body's remeshed surface and its tetrahedra.
struct Meshed {
    mesh::Surface surface;
    mesh::VolumeMesh volume;
};

/// Repaired, remeshed and filled as the program does it, with edges of `share` of the longest side.
Meshed meshed(const mesh::Surface& surface, double share = 0.06);

/// Holds the `share` of the longest side at the low end of the longest axis.
mesh::PlaneRegion end_clamp(const mesh::Surface& surface, double share = 0.05);

/// A rigid motion: x -> turn x + shift.
struct Motion {
    Mat3 turn = Mat3::Identity();
    Vec3 shift = Vec3::Zero();
    mesh::Surface operator()(mesh::Surface surface) const;
    mesh::PlaneRegion operator()(mesh::PlaneRegion region) const;
};
Motion some_motion();

/// Vertices moved along their normals by normal noise of 1 sigma = `share` of the longest side.
mesh::Surface noisy(mesh::Surface surface, double share, unsigned seed);

/// The same surface, its vertices and triangles in another order.
mesh::Surface shuffled(const mesh::Surface& surface, unsigned seed);

}  // namespace palpate::skeleton
