#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <vector>

#include "mesh/core/surface.h"

/// Surfaces as CGAL sees them. For .cpp files that use CGAL only.
namespace palpate::mesh::cgal {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

/// Corners and triangles without any order among neighbours.
struct Soup {
    std::vector<Point> points;
    std::vector<std::array<std::size_t, 3>> triangles;
};

inline Soup to_soup(const Surface& surface) {
    Soup soup;
    soup.points.reserve(static_cast<std::size_t>(surface.vertices.rows()));
    for (const auto& v : surface.vertices.rowwise()) soup.points.emplace_back(v[0], v[1], v[2]);
    soup.triangles.reserve(static_cast<std::size_t>(surface.triangles.rows()));
    for (const auto& t : surface.triangles.rowwise())
        soup.triangles.push_back(
            {static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2])});
    return soup;
}

inline Surface from_soup(const Soup& soup) {
    Surface surface;
    surface.vertices.resize(static_cast<Eigen::Index>(soup.points.size()), 3);
    surface.triangles.resize(static_cast<Eigen::Index>(soup.triangles.size()), 3);
    for (Eigen::Index v = 0; v < surface.vertices.rows(); ++v) {
        const Point& p = soup.points[static_cast<std::size_t>(v)];
        surface.vertices.row(v) << p.x(), p.y(), p.z();
    }
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
        for (Eigen::Index i = 0; i < 3; ++i)
            surface.triangles(t, i) =
                static_cast<int>(soup.triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(i)]);
    return surface;
}

/// @pre no edge has more than two triangles, neighbours agree about the outside, no corner joins two fans.
inline Mesh to_mesh(const Soup& soup) {
    Mesh mesh;
    CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, mesh);
    return mesh;
}

inline bool is_mesh(const Soup& soup) {
    return CGAL::Polygon_mesh_processing::is_polygon_soup_a_polygon_mesh(soup.triangles);
}

/// Rows in the order of the mesh's indices, after removed elements are dropped.
inline Surface from_mesh(Mesh& mesh) {
    mesh.collect_garbage();
    Surface surface;
    surface.vertices.resize(static_cast<Eigen::Index>(mesh.number_of_vertices()), 3);
    surface.triangles.resize(static_cast<Eigen::Index>(mesh.number_of_faces()), 3);
    for (const auto v : mesh.vertices()) {
        const Point& p = mesh.point(v);
        surface.vertices.row(static_cast<Eigen::Index>(v.idx())) << p.x(), p.y(), p.z();
    }
    for (const auto f : mesh.faces()) {
        Eigen::Index corner = 0;
        for (const auto v : mesh.vertices_around_face(mesh.halfedge(f)))
            surface.triangles(static_cast<Eigen::Index>(f.idx()), corner++) = static_cast<int>(v.idx());
    }
    return surface;
}

}  // namespace palpate::mesh::cgal
