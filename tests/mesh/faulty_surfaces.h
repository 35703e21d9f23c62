#pragma once

#include <numeric>
#include <vector>

#include "mesh/core/surface.h"

/// Surfaces with one fault each, and ways to put faults in.
namespace palpate::mesh {

inline Surface cube() { return make_box({0, 0, 0}, {10, 10, 10}, {4, 4, 4}); }

/// The triangles of both, nothing shared.
inline Surface join(const Surface& a, const Surface& b) {
    Surface both;
    both.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
    both.vertices << a.vertices, b.vertices;
    both.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
    both.triangles << a.triangles, (b.triangles.array() + static_cast<int>(a.vertices.rows())).matrix();
    return both;
}

inline Surface inside_out(Surface surface) {
    surface.triangles.col(1).swap(surface.triangles.col(2));
    return surface;
}

/// A ball of radius 10 with a hollow of radius 5, turned as it should be.
inline Surface hollow_ball() { return join(make_sphere({0, 0, 0}, 10, 3), inside_out(make_sphere({0, 0, 0}, 5, 2))); }

/// Three corners a triangle, as STL has it.
inline Surface unwelded(const Surface& surface) {
    Surface soup{Points(surface.triangles.size(), 3), Triangles(surface.triangles.rows(), 3)};
    for (int t = 0; t < surface.triangles.rows(); ++t)
        for (int i = 0; i < 3; ++i) {
            soup.vertices.row(3 * t + i) = surface.vertices.row(surface.triangles(t, i));
            soup.triangles(t, i) = 3 * t + i;
        }
    return soup;
}

inline Surface without_triangle(Surface surface, int t) {
    surface.triangles.row(t) = surface.triangles.row(surface.triangles.rows() - 1);
    surface.triangles.conservativeResize(surface.triangles.rows() - 1, 3);
    return surface;
}

inline Surface with_triangle(Surface surface, int a, int b, int c) {
    surface.triangles.conservativeResize(surface.triangles.rows() + 1, 3);
    surface.triangles.bottomRows(1) << a, b, c;
    return surface;
}

inline Surface with_twin(const Surface& surface) {
    return with_triangle(surface, surface.triangles(0, 0), surface.triangles(0, 1), surface.triangles(0, 2));
}

inline Surface with_flipped_triangle(Surface surface) {
    std::swap(surface.triangles(0, 1), surface.triangles(0, 2));
    return surface;
}

/// A fin stands on one edge of the first triangle.
inline Surface with_fin(Surface surface) {
    const auto n = static_cast<int>(surface.vertices.rows());
    const Vec3 outward = area_vectors(surface).row(0).normalized();
    surface.vertices.conservativeResize(n + 1, 3);
    surface.vertices.row(n) = surface.vertices.row(surface.triangles(0, 0)) + outward.transpose();
    return with_triangle(surface, surface.triangles(0, 0), surface.triangles(0, 1), n);
}

/// One vertex of the bottom is pushed through the top.
inline Surface with_spike(Surface surface) {
    Eigen::Index vertex = 0;
    (surface.vertices.rowwise() - Eigen::RowVector3d(5, 5, 0)).rowwise().squaredNorm().minCoeff(&vertex);
    surface.vertices(vertex, 2) = 12;
    return surface;
}

/// The side z = 10 of the cube alone.
inline Surface open_sheet() {
    const Surface whole = cube();
    Surface sheet{whole.vertices, Triangles(0, 3)};
    for (const auto& t : whole.triangles.rowwise())
        if (whole.vertices(t[0], 2) == 10 && whole.vertices(t[1], 2) == 10 && whole.vertices(t[2], 2) == 10)
            sheet = with_triangle(sheet, t[0], t[1], t[2]);
    return sheet;
}

/// Two tetrahedra that touch in a point.
inline Surface bow_tie() {
    Surface surface{Points(7, 3), Triangles(8, 3)};
    surface.vertices << 0, 0, 0, 1, 0, 1, 0, 1, 1, -1, -1, 1, 1, 0, -1, 0, 1, -1, -1, -1, -1;
    surface.triangles << 0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3, 0, 4, 5, 0, 5, 6, 0, 6, 4, 4, 6, 5;
    return surface;
}

}  // namespace palpate::mesh
