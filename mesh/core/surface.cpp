#include "mesh/core/surface.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <utility>
#include <vector>

namespace palpate::mesh {

namespace {

Vec3 corner(const Surface& surface, Eigen::Index triangle, int which) {
    return surface.vertices.row(surface.triangles(triangle, which)).transpose();
}

Vec3 area_vector(const Surface& surface, Eigen::Index triangle) {
    const Vec3 a = corner(surface, triangle, 0);
    return 0.5 * (corner(surface, triangle, 1) - a).cross(corner(surface, triangle, 2) - a);
}

Points rows(const std::vector<Vec3>& points) {
    Points result(static_cast<Eigen::Index>(points.size()), 3);
    for (std::size_t i = 0; i < points.size(); ++i) result.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
    return result;
}

/// A number for each point of a box's lattice.
class BoxLattice {
public:
    explicit BoxLattice(const Eigen::Vector3i& quads)
        : x_(quads.x() + 1), y_(quads.y() + 1), numbers_(x_ * y_ * (static_cast<std::size_t>(quads.z()) + 1), -1) {}
    int& operator()(const Eigen::Array3i& at) { return numbers_[at.x() + x_ * (at.y() + y_ * at.z())]; }

private:
    std::size_t x_, y_;
    std::vector<int> numbers_;
};

Triangles rows(const std::vector<std::array<int, 3>>& triangles) {
    Triangles result(static_cast<Eigen::Index>(triangles.size()), 3);
    for (std::size_t i = 0; i < triangles.size(); ++i)
        result.row(static_cast<Eigen::Index>(i)) << triangles[i][0], triangles[i][1], triangles[i][2];
    return result;
}

}  // namespace

Box bounding_box(const Points& points) {
    assert(points.rows() > 0);
    return {points.colwise().minCoeff().transpose(), points.colwise().maxCoeff().transpose()};
}

double signed_volume(const Surface& surface) {
    if (surface.vertices.rows() == 0) return 0;
    // About the first vertex and not the origin: a body far away would lose its digits.
    const Vec3 origin = surface.vertices.row(0).transpose();
    double volume = 0;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
        volume += (corner(surface, t, 0) - origin).dot(area_vector(surface, t)) / 3;
    return volume;
}

double area(const Surface& surface) {
    double sum = 0;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) sum += area_vector(surface, t).norm();
    return sum;
}

Points area_vectors(const Surface& surface) {
    Points result(surface.triangles.rows(), 3);
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) result.row(t) = area_vector(surface, t).transpose();
    return result;
}

Points vertex_normals(const Surface& surface) {
    Points normals = Points::Zero(surface.vertices.rows(), 3);
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
        const Vec3 normal = area_vector(surface, t).normalized();
        for (int c = 0; c < 3; ++c) {
            const Vec3 p = corner(surface, t, c);
            const Vec3 a = corner(surface, t, (c + 1) % 3) - p;
            const Vec3 b = corner(surface, t, (c + 2) % 3) - p;
            const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
            normals.row(surface.triangles(t, c)) += angle * normal.transpose();
        }
    }
    normals.rowwise().normalize();
    return normals;
}

Vec3 mean_normal(const Surface& surface, const Vec3& point, double radius) {
    const Points areas = area_vectors(surface);
    Vec3 sum = Vec3::Zero(), nearest = Vec3::Zero();
    double least = INFINITY;
    for (Eigen::Index t = 0; t < areas.rows(); ++t) {
        Vec3 centre = Vec3::Zero();
        for (const int vertex : surface.triangles.row(t)) centre += surface.vertices.row(vertex).transpose() / 3;
        const double distance = (centre - point).norm();
        if (distance < radius) sum += areas.row(t);
        if (distance < least) {
            least = distance;
            nearest = areas.row(t);
        }
    }
    return (sum.norm() > 0 ? sum : nearest).normalized();
}

Surface make_box(const Vec3& min, const Vec3& max, const Eigen::Vector3i& quads) {
    assert((quads.array() > 0).all() && (max - min).minCoeff() > 0);

    // Vertices: the lattice points on the border, numbered in the order of the lattice.
    std::vector<Vec3> vertices;
    BoxLattice number(quads);
    for (int k = 0; k <= quads.z(); ++k)
        for (int j = 0; j <= quads.y(); ++j)
            for (int i = 0; i <= quads.x(); ++i) {
                const Eigen::Array3i at(i, j, k);
                if ((at > 0).all() && (at < quads.array()).all()) continue;
                number(at) = static_cast<int>(vertices.size());
                const Eigen::Array3d share = at.cast<double>() / quads.cast<double>().array();
                vertices.emplace_back((1 - share) * min.array() + share * max.array());
            }

    // Sides: for each axis the low and the high one; u, v, axis are right-handed, so u x v looks up the axis.
    std::vector<std::array<int, 3>> triangles;
    for (int axis = 0; axis < 3; ++axis)
        for (const bool high : {false, true}) {
            const int u = (axis + 1) % 3;
            const int v = (axis + 2) % 3;
            Eigen::Array3i at = Eigen::Array3i::Zero();
            at[axis] = high ? quads[axis] : 0;
            for (int i = 0; i < quads[u]; ++i)
                for (int j = 0; j < quads[v]; ++j) {
                    const auto vertex = [&](int du, int dv) {
                        at[u] = i + du;
                        at[v] = j + dv;
                        return number(at);
                    };
                    std::array<int, 3> lower{vertex(0, 0), vertex(1, 0), vertex(1, 1)};
                    std::array<int, 3> upper{vertex(0, 0), vertex(1, 1), vertex(0, 1)};
                    if (!high) std::swap(lower[1], lower[2]);
                    if (!high) std::swap(upper[1], upper[2]);
                    triangles.insert(triangles.end(), {lower, upper});
                }
        }
    return {rows(vertices), rows(triangles)};
}

Surface make_sphere(const Vec3& center, double radius, int levels) {
    assert(radius > 0 && levels >= 0);
    // An icosahedron: the corners of three golden rectangles.
    const double g = std::numbers::phi;
    std::vector<Vec3> vertices{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                               {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    for (Vec3& v : vertices) v.normalize();
    std::vector<std::array<int, 3>> triangles{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                              {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                              {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                              {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};

    // Each level cuts every triangle into four, at the midsides pushed out to the sphere.
    for (int level = 0; level < levels; ++level) {
        std::unordered_map<std::uint64_t, int> middle_of_edge;
        const auto middle = [&](int a, int b) {
            const auto [low, high] = std::minmax(a, b);
            const std::uint64_t key = (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint64_t>(high);
            const auto [entry, is_new] = middle_of_edge.try_emplace(key, static_cast<int>(vertices.size()));
            if (is_new) vertices.emplace_back((vertices[a] + vertices[b]).normalized());
            return entry->second;
        };
        std::vector<std::array<int, 3>> finer;
        finer.reserve(4 * triangles.size());
        for (const auto& [a, b, c] : triangles) {
            const int ab = middle(a, b);
            const int bc = middle(b, c);
            const int ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        triangles = std::move(finer);
    }
    for (Vec3& v : vertices) v = center + radius * v;
    return {rows(vertices), rows(triangles)};
}

}  // namespace palpate::mesh
