#include "mesh/topology/shells.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::mesh {
namespace {

Vec3 centroid(const Surface& surface, Eigen::Index triangle) {
    const auto corners = surface.triangles.row(triangle);
    return (surface.vertices.row(corners[0]) + surface.vertices.row(corners[1]) + surface.vertices.row(corners[2])) / 3;
}

/// Those triangles alone, with the vertices that they use.
Surface part(const Surface& surface, const std::vector<int>& triangles) {
    std::map<int, int> row_of;
    Surface result;
    result.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
    for (Eigen::Index t = 0; t < result.triangles.rows(); ++t)
        for (int i = 0; i < 3; ++i) {
            const int v = surface.triangles(triangles[static_cast<std::size_t>(t)], i);
            result.triangles(t, i) = row_of.try_emplace(v, static_cast<int>(row_of.size())).first->second;
        }
    result.vertices.resize(static_cast<Eigen::Index>(row_of.size()), 3);
    for (const auto& [v, row] : row_of) result.vertices.row(row) = surface.vertices.row(v);
    return result;
}

/// How many of the shells hold the point.
int count_around(const std::vector<SurfaceTree>& trees, const Vec3& point) {
    return static_cast<int>(
        std::count_if(trees.begin(), trees.end(), [&](const SurfaceTree& tree) { return tree.inside(point); }));
}

std::vector<SurfaceTree> trees_of(const std::vector<Shell>& shells) {
    std::vector<SurfaceTree> trees;
    trees.reserve(shells.size());
    for (const Shell& shell : shells) trees.emplace_back(shell.surface);
    return trees;
}

/// The rows of each part's triangles.
std::vector<std::vector<int>> triangles_of_parts(const Surface& surface) {
    std::vector<std::vector<int>> parts;
    const std::vector<int> number = connected_parts(surface);
    for (std::size_t t = 0; t < number.size(); ++t) {
        const auto p = static_cast<std::size_t>(number[t]);
        if (p >= parts.size()) parts.resize(p + 1);
        parts[p].push_back(static_cast<int>(t));
    }
    return parts;
}

}  // namespace

std::vector<int> connected_parts(const Surface& surface) {
    const auto m = static_cast<std::size_t>(surface.triangles.rows());
    std::vector<int> leader(m);
    std::iota(leader.begin(), leader.end(), 0);
    const auto find = [&](int t) {
        while (leader[static_cast<std::size_t>(t)] != t)
            t = leader[static_cast<std::size_t>(t)] =
                leader[static_cast<std::size_t>(leader[static_cast<std::size_t>(t)])];
        return t;
    };

    // Triangles that share an edge join; the smallest row leads.
    std::map<std::pair<int, int>, int> first_at;
    for (int t = 0; t < static_cast<int>(m); ++t)
        for (int i = 0; i < 3; ++i) {
            const auto [a, b] = std::minmax({surface.triangles(t, i), surface.triangles(t, (i + 1) % 3)});
            const auto [edge, is_new] = first_at.try_emplace({a, b}, t);
            if (is_new) continue;
            const int p = find(t), q = find(edge->second);
            leader[static_cast<std::size_t>(std::max(p, q))] = std::min(p, q);
        }

    std::vector<int> number(m, -1);
    int count = 0;
    for (std::size_t t = 0; t < m; ++t) {
        auto& lead = number[static_cast<std::size_t>(find(static_cast<int>(t)))];
        if (lead < 0) lead = count++;
        number[t] = lead;
    }
    return number;
}

std::vector<Surface> split_parts(const Surface& surface) {
    std::vector<Surface> parts;
    for (const auto& triangles : triangles_of_parts(surface)) parts.push_back(part(surface, triangles));
    return parts;
}

std::vector<Shell> find_shells(const Surface& surface) {
    std::vector<Shell> shells;
    for (auto& triangles : triangles_of_parts(surface)) {
        Shell shell{part(surface, triangles), std::move(triangles)};
        shell.volume = signed_volume(shell.surface);
        shells.push_back(std::move(shell));
    }
    if (shells.size() < 2) return shells;

    const std::vector<SurfaceTree> trees = trees_of(shells);
    for (std::size_t s = 0; s < shells.size(); ++s) {
        const Vec3 point = centroid(shells[s].surface, 0);
        for (std::size_t other = 0; other < shells.size(); ++other)
            shells[s].depth += other != s && trees[other].inside(point);
    }
    return shells;
}

Surface turn_outward(const Surface& surface) {
    Surface result = surface;
    for (const Shell& shell : find_shells(surface)) {
        if ((shell.volume > 0) != shell.is_cavity()) continue;
        for (const int t : shell.triangles) std::swap(result.triangles(t, 1), result.triangles(t, 2));
    }
    return result;
}

Surface with_cavity(Surface body, const Surface& wall) {
    const Eigen::Index vertices = body.vertices.rows(), triangles = body.triangles.rows();
    body.vertices.conservativeResize(vertices + wall.vertices.rows(), 3);
    body.vertices.bottomRows(wall.vertices.rows()) = wall.vertices;
    body.triangles.conservativeResize(triangles + wall.triangles.rows(), 3);
    const bool looks_outward = signed_volume(wall) > 0;
    for (Eigen::Index t = 0; t < wall.triangles.rows(); ++t) {
        Eigen::RowVector3i corners = wall.triangles.row(t).array() + static_cast<int>(vertices);
        if (looks_outward) std::swap(corners[0], corners[2]);
        body.triangles.row(triangles + t) = corners;
    }
    return body;
}

double enclosed_volume(const std::vector<Shell>& shells) {
    double volume = 0;
    for (const Shell& shell : shells) volume += shell.is_cavity() ? -std::abs(shell.volume) : std::abs(shell.volume);
    return volume;
}

Points cavity_points(const std::vector<Shell>& shells) {
    std::vector<Vec3> points;
    std::vector<SurfaceTree> trees;
    for (std::size_t s = 0; s < shells.size(); ++s) {
        const Shell& shell = shells[s];
        if (!shell.is_cavity()) continue;
        if (trees.empty()) trees = trees_of(shells);

        // From the largest triangles step off the wall into the cavity, far first.
        const Points vectors = area_vectors(shell.surface);
        const Eigen::VectorXd areas = vectors.rowwise().norm();
        std::vector<int> by_area(static_cast<std::size_t>(areas.size()));
        std::iota(by_area.begin(), by_area.end(), 0);
        std::stable_sort(by_area.begin(), by_area.end(), [&](int a, int b) { return areas[a] > areas[b]; });
        const double sign = shell.volume > 0 ? -1 : 1;
        const auto search = [&]() -> Vec3 {
            for (const double step : {0.5, 0.1, 0.01, 1e-3, 1e-4})
                for (const int t : by_area) {
                    const Vec3 normal = vectors.row(t).normalized();
                    Vec3 point = centroid(shell.surface, t) + sign * step * std::sqrt(areas[t]) * normal;
                    if (trees[s].inside(point) && count_around(trees, point) == shell.depth + 1) return point;
                }
            throw SolverFailure(
                fmt::format("No point was found inside a cavity of {} triangles. Mend or remove that inner "
                            "shell.",
                            shell.triangles.size()));
        };
        points.push_back(search());
    }
    Points result(static_cast<Eigen::Index>(points.size()), 3);
    for (std::size_t i = 0; i < points.size(); ++i) result.row(static_cast<Eigen::Index>(i)) = points[i];
    return result;
}

}  // namespace palpate::mesh
