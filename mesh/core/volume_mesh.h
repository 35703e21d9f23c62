#pragma once

#include "mesh/core/surface.h"
#include "mesh/types.h"

namespace palpate::mesh {

/// A body of tetrahedra, linear or quadratic [mm].
///
/// Quadratic elements number their nodes as VTK does: corners 0-3, then the midsides of
/// (0,1) (1,2) (2,0) (0,3) (1,3) (2,3); quadratic faces: corners 0-2, then (0,1) (1,2) (2,0).
struct VolumeMesh {
    Points nodes;           // (n x 3)
    Tetrahedra tetrahedra;  // (m x 4 or 10), positive volume
    Faces faces;            // boundary, (k x 3 or 6), outward

    bool is_quadratic() const { return tetrahedra.cols() == 10; }
};

/// The boundary faces, outward: those that belong to one element only; with midsides where the elements have them.
/// @pre every tetrahedron has positive volume.
Faces boundary_faces(const Tetrahedra& tetrahedra);

/// The same body with straight-sided quadratic elements; a quadratic mesh is returned unchanged.
VolumeMesh to_quadratic(const VolumeMesh& mesh);

/// Volume of each element by its corners (m) [mm^3].
Eigen::VectorXd element_volumes(const VolumeMesh& mesh);

/// The boundary as a surface: its nodes only, quadratic faces cut into four triangles.
/// `node_of_vertex` (when asked for) tells the body's node behind each vertex.
Surface boundary_surface(const VolumeMesh& mesh, Eigen::VectorXi* node_of_vertex = nullptr);

/// A regular bar [min, max] of 6 tetrahedra a cell, linear; for samples and tests.
VolumeMesh make_bar(const Vec3& min, const Vec3& max, const Eigen::Vector3i& cells);

}  // namespace palpate::mesh
