#include "fem/interpolation/nearest_face.h"

namespace palpate::fem {

namespace {

/// Nodes of the four triangles of a quadratic face: one at each corner, one in the middle.
constexpr int quarters[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

/// Barycentric coordinates of a quadratic face's nodes (3 x 6).
const Eigen::Matrix<double, 3, 6> node_coordinates{
    {1, 0, 0, 0.5, 0, 0.5}, {0, 1, 0, 0.5, 0.5, 0}, {0, 0, 1, 0, 0.5, 0.5}};

mesh::Surface facets(const mesh::VolumeMesh& mesh) {
    if (!mesh.is_quadratic()) return {mesh.nodes, mesh.faces};
    Triangles triangles(4 * mesh.faces.rows(), 3);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        for (int q = 0; q < 4; ++q) {
            for (int k = 0; k < 3; ++k) triangles(4 * f + q, k) = mesh.faces(f, quarters[q][k]);
        }
    }
    return {mesh.nodes, triangles};
}

}  // namespace

NearestFace::NearestFace(const mesh::VolumeMesh& mesh)
    : triangles_per_face_(mesh.is_quadratic() ? 4 : 1), tree_(facets(mesh)) {}

FacePoint NearestFace::closest(const Vec3& point) const {
    const mesh::SurfacePoint found = tree_.closest(point);
    FacePoint result{found.triangle / triangles_per_face_, found.barycentric, found.position, found.distance};
    if (triangles_per_face_ == 4) {
        const auto& corners = quarters[found.triangle % 4];
        result.l.setZero();
        for (int k = 0; k < 3; ++k) result.l += found.barycentric(k) * node_coordinates.col(corners[k]);
    }
    return result;
}

}  // namespace palpate::fem
