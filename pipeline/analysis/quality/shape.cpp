#include "pipeline/analysis/quality/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::pipeline {
namespace {

constexpr int cells = 128;  // of the grid, along the longest side

/// Points x = origin + h (i, j, k); those of one (j, k) are a column along x.
struct Grid {
    Vec3 origin = Vec3::Zero();
    double h = 1;  // [mm]
    Eigen::Vector3i size = Eigen::Vector3i::Zero();

    double at(int axis, int index) const { return origin[axis] + h * index; }
    int first_beyond(int axis, double x) const {
        return std::clamp(static_cast<int>(std::ceil((x - origin[axis]) / h)), 0, size[axis]);
    }
    std::size_t column(int j, int k) const {
        return static_cast<std::size_t>(j) + static_cast<std::size_t>(size.y()) * static_cast<std::size_t>(k);
    }
    std::size_t columns() const { return column(0, size.z()); }
};

/// Off the surface's own vertices, which often lie on round numbers: no column meets an edge.
Grid grid_over(const skeleton::Model& model) {
    mesh::Box box = mesh::bounding_box(model.surface.vertices);
    Grid grid{.h = box.longest_side() / cells};
    for (const skeleton::Sphere& sphere : model.spheres) {
        box.min = box.min.cwiseMin(sphere.center - Vec3::Constant(sphere.radius));
        box.max = box.max.cwiseMax(sphere.center + Vec3::Constant(sphere.radius));
    }
    grid.origin = box.min + grid.h * Vec3(0.3819660, 0.4142136, 0.3027756);
    grid.size = (box.extent() / grid.h).array().ceil().cast<int>();
    return grid;
}

/// Where each column crosses the surface, ascending [mm].
std::vector<std::vector<double>> crossings(const mesh::Surface& surface, const Grid& grid) {
    std::vector<std::vector<double>> found(grid.columns());
    const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); };
    for (const auto& triangle : surface.triangles.rowwise()) {
        std::array<Vec3, 3> p;
        std::array<Eigen::Vector2d, 3> q;  // along the columns
        for (int c = 0; c < 3; ++c) {
            p[c] = surface.vertices.row(triangle[c]);
            q[c] = p[c].tail<2>();
        }
        const double twice_area = cross(q[1] - q[0], q[2] - q[0]);
        if (twice_area == 0) continue;
        const auto [low_y, high_y] = std::minmax({q[0].x(), q[1].x(), q[2].x()});
        const auto [low_z, high_z] = std::minmax({q[0].y(), q[1].y(), q[2].y()});
        for (int k = grid.first_beyond(2, low_z); k < grid.first_beyond(2, high_z); ++k) {
            for (int j = grid.first_beyond(1, low_y); j < grid.first_beyond(1, high_y); ++j) {
                const Eigen::Vector2d at(grid.at(1, j), grid.at(2, k));
                const Vec3 share =
                    Vec3(cross(q[1] - at, q[2] - at), cross(q[2] - at, q[0] - at), cross(q[0] - at, q[1] - at)) /
                    twice_area;
                if (share.minCoeff() < 0) continue;
                found[grid.column(j, k)].push_back(share[0] * p[0].x() + share[1] * p[1].x() + share[2] * p[2].x());
            }
        }
    }
    for (std::vector<double>& column : found) std::ranges::sort(column);
    return found;
}

/// For each point of a column whether some sphere holds it.
std::vector<char> in_spheres(const std::vector<skeleton::Sphere>& spheres, const Grid& grid, int j, int k) {
    std::vector<char> inside(static_cast<std::size_t>(grid.size.x()), 0);
    for (const skeleton::Sphere& sphere : spheres) {
        const double off = std::hypot(grid.at(1, j) - sphere.center.y(), grid.at(2, k) - sphere.center.z());
        if (off >= sphere.radius) continue;
        const double half = std::sqrt(sphere.radius * sphere.radius - off * off);
        std::fill(inside.begin() + grid.first_beyond(0, sphere.center.x() - half),
                  inside.begin() + grid.first_beyond(0, sphere.center.x() + half), 1);
    }
    return inside;
}

std::vector<char> in_body(const std::vector<double>& crossings, const Grid& grid) {
    std::vector<char> inside(static_cast<std::size_t>(grid.size.x()), 0);
    for (std::size_t c = 0; c + 1 < crossings.size(); c += 2) {
        std::fill(inside.begin() + grid.first_beyond(0, crossings[c]),
                  inside.begin() + grid.first_beyond(0, crossings[c + 1]), 1);
    }
    return inside;
}

double distance_outside(const std::vector<skeleton::Sphere>& spheres, const Vec3& point) {
    double least = std::numeric_limits<double>::infinity();
    for (const skeleton::Sphere& sphere : spheres) {
        least = std::min(least, (point - sphere.center).norm() - sphere.radius);
    }
    return least;
}

}  // namespace

ShapeQuality shape_quality(const skeleton::Model& model) {
    ShapeQuality quality;
    for (const auto& row : model.surface.vertices.rowwise()) {
        const Vec3 vertex = row;
        if (mesh::contains(model.supports, vertex)) continue;
        quality.coverage = std::max(quality.coverage, distance_outside(model.spheres, vertex));
    }
    quality.coverage_share = quality.coverage / mesh::bounding_box(model.surface.vertices).longest_side();

    const Grid grid = grid_over(model);
    const std::vector<std::vector<double>> surface = crossings(model.surface, grid);
    double body = 0, spheres = 0, both = 0;  // points in them
    for (int k = 0; k < grid.size.z(); ++k) {
        for (int j = 0; j < grid.size.y(); ++j) {
            const std::vector<char> of_body = in_body(surface[grid.column(j, k)], grid);
            const std::vector<char> of_spheres = in_spheres(model.spheres, grid, j, k);
            for (int i = 0; i < grid.size.x(); ++i) {
                if (!of_body[i] && !of_spheres[i]) continue;
                if (mesh::contains(model.supports, Vec3(grid.at(0, i), grid.at(1, j), grid.at(2, k)))) continue;
                body += of_body[i];
                spheres += of_spheres[i];
                both += of_body[i] && of_spheres[i];
            }
        }
    }
    if (body > 0) quality.covered = both / body;
    if (spheres > 0) quality.outside = 1 - both / spheres;
    return quality;
}

}  // namespace palpate::pipeline
