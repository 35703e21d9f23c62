#include "meshes/breaks.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <utility>

namespace palpate::bench {
namespace {

using mesh::Surface;

constexpr unsigned seed = 7;

double diagonal(const Surface& surface) { return mesh::bounding_box(surface.vertices).diagonal(); }

Vec3 centroid(const Surface& surface, Eigen::Index t) {
    return (surface.vertices.row(surface.triangles(t, 0)) + surface.vertices.row(surface.triangles(t, 1)) +
            surface.vertices.row(surface.triangles(t, 2))) /
           3;
}

Surface with_triangles(const Surface& surface, const std::vector<Eigen::RowVector3i>& triangles) {
    Surface result{surface.vertices, Triangles(std::ssize(triangles), 3)};
    for (std::size_t t = 0; t < triangles.size(); ++t)
        result.triangles.row(static_cast<Eigen::Index>(t)) = triangles[t];
    return result;
}

std::vector<Eigen::RowVector3i> triangles_of(const Surface& surface) {
    std::vector<Eigen::RowVector3i> triangles;
    for (const auto& t : surface.triangles.rowwise()) triangles.emplace_back(t);
    return triangles;
}

std::vector<Eigen::Index> some_triangles(const Surface& surface, std::size_t count) {
    std::mt19937 engine(seed);
    std::vector<Eigen::Index> picked;
    for (std::size_t i = 0; i < count; ++i)
        picked.push_back(static_cast<Eigen::Index>(engine() % static_cast<unsigned>(surface.triangles.rows())));
    return picked;
}

/// Edges longer than this are halved until none is left.
Surface refined(Surface surface, double longest) {
    for (bool again = true; again;) {
        std::map<std::pair<int, int>, int> middle;
        std::vector<Eigen::RowVector3i> triangles;
        std::vector<Eigen::RowVector3d> added;
        again = false;
        for (const auto& t : surface.triangles.rowwise()) {
            // The longest side alone is cut: its neighbour does the same, now or in a later round.
            int side = 0;
            std::array<double, 3> length{};
            for (int i = 0; i < 3; ++i)
                length[static_cast<std::size_t>(i)] =
                    (surface.vertices.row(t[i]) - surface.vertices.row(t[(i + 1) % 3])).norm();
            side = static_cast<int>(std::ranges::max_element(length) - length.begin());
            if (length[static_cast<std::size_t>(side)] > longest) {
                const std::pair<int, int> edge = std::minmax(t[side], t[(side + 1) % 3]);
                const auto [entry, is_new] =
                    middle.try_emplace(edge, static_cast<int>(surface.vertices.rows() + std::ssize(added)));
                if (is_new) added.push_back((surface.vertices.row(edge.first) + surface.vertices.row(edge.second)) / 2);
            }
        }
        for (const auto& t : surface.triangles.rowwise()) {
            std::vector<int> loop;
            for (int i = 0; i < 3; ++i) {
                loop.push_back(t[i]);
                const std::pair<int, int> edge = std::minmax(t[i], t[(i + 1) % 3]);
                if (const auto found = middle.find(edge); found != middle.end()) loop.push_back(found->second);
            }
            // Begin behind a corner, so that a fan from there has no triangle without area.
            const auto begin = std::ranges::find_if(loop, [&](int v) { return v >= surface.vertices.rows(); });
            if (begin != loop.end()) std::rotate(loop.begin(), begin, loop.end());
            for (std::size_t i = 1; i + 1 < loop.size(); ++i) triangles.emplace_back(loop[0], loop[i], loop[i + 1]);
        }
        again = !added.empty();
        const Eigen::Index n = surface.vertices.rows();
        surface.vertices.conservativeResize(n + std::ssize(added), 3);
        for (std::size_t i = 0; i < added.size(); ++i)
            surface.vertices.row(n + static_cast<Eigen::Index>(i)) = added[i];
        surface = with_triangles(surface, triangles);
    }
    return surface;
}

/// Three holes, each of what lies within 4 % of the diagonal of a triangle's centre, in triangles of 3 % at most.
Surface holes(const Surface& original) {
    const Surface surface = refined(original, 0.03 * diagonal(original));
    std::vector<Eigen::RowVector3i> kept;
    const auto picked = some_triangles(surface, 3);
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
        const bool is_gone = std::ranges::any_of(picked, [&](Eigen::Index p) {
            return p == t || (centroid(surface, p) - centroid(surface, t)).norm() < 0.04 * diagonal(surface);
        });
        if (!is_gone) kept.emplace_back(surface.triangles.row(t));
    }
    return with_triangles(surface, kept);
}

Surface flips(const Surface& surface) {
    Surface result = surface;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); t += 5)
        std::swap(result.triangles(t, 1), result.triangles(t, 2));
    return result;
}

Surface duplicates(const Surface& surface) {
    auto triangles = triangles_of(surface);
    for (Eigen::Index t = 0; t < surface.triangles.rows(); t += 7) triangles.emplace_back(surface.triangles.row(t));
    return with_triangles(surface, triangles);
}

Surface noise(const Surface& surface) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal(0, 0.002 * diagonal(surface));
    Surface result = surface;
    for (double& x : result.vertices.reshaped()) x += normal(engine);
    return result;
}

/// Ten vertices are pulled along the surface over their neighbours, by three edges and 3 % of the diagonal at most.
Surface crossing(const Surface& surface) {
    Surface result = surface;
    for (const Eigen::Index t : some_triangles(surface, 10)) {
        const int vertex = surface.triangles(t, 0);
        const Vec3 along = (centroid(surface, t) - surface.vertices.row(vertex).transpose()) * 4.5;
        const double length = std::min(along.norm(), 0.03 * diagonal(surface));
        result.vertices.row(vertex) += length * along.normalized().transpose();
    }
    return result;
}

Surface fins(const Surface& surface) {
    auto triangles = triangles_of(surface);
    Points vertices = surface.vertices;
    const Points normals = mesh::area_vectors(surface).rowwise().normalized();
    for (const Eigen::Index t : some_triangles(surface, 5)) {
        const auto n = static_cast<int>(vertices.rows());
        vertices.conservativeResize(n + 1, 3);
        vertices.row(n) = centroid(surface, t).transpose() + 0.02 * diagonal(surface) * normals.row(t);
        triangles.emplace_back(surface.triangles(t, 0), surface.triangles(t, 1), n);
    }
    Surface result = with_triangles(surface, triangles);
    result.vertices = vertices;
    return result;
}

/// Triangles are cut through a point that lies all but on one of their edges.
Surface slivers(const Surface& surface) {
    auto triangles = triangles_of(surface);
    Points vertices = surface.vertices;
    for (const Eigen::Index t : some_triangles(surface, 30)) {
        const auto n = static_cast<int>(vertices.rows());
        const Eigen::RowVector3i corners = triangles[static_cast<std::size_t>(t)];
        vertices.conservativeResize(n + 1, 3);
        const Eigen::RowVector3d on_edge = (vertices.row(corners[0]) + vertices.row(corners[1])) / 2;
        vertices.row(n) = on_edge + 1e-5 * (vertices.row(corners[2]) - on_edge);
        triangles[static_cast<std::size_t>(t)] << corners[0], corners[1], n;
        triangles.emplace_back(corners[1], corners[2], n);
        triangles.emplace_back(corners[2], corners[0], n);
    }
    Surface result = with_triangles(surface, triangles);
    result.vertices = vertices;
    return result;
}

Surface two_shells(const Surface& surface) {
    const Surface ball = overlapping_ball(surface);
    Surface both{Points(surface.vertices.rows() + ball.vertices.rows(), 3),
                 Triangles(surface.triangles.rows() + ball.triangles.rows(), 3)};
    both.vertices << surface.vertices, ball.vertices;
    both.triangles << surface.triangles, (ball.triangles.array() + static_cast<int>(surface.vertices.rows())).matrix();
    return both;
}

constexpr double far = 1e5;  // diagonals

Surface offset(const Surface& surface) {
    Surface result = surface;
    result.vertices.rowwise() += Eigen::RowVector3d(1, -0.7, 0.4).normalized() * far * diagonal(surface);
    return result;
}

}  // namespace

Surface overlapping_ball(const Surface& surface) {
    return mesh::make_sphere(surface.vertices.row(surface.triangles(0, 0)), 0.1 * diagonal(surface), 3);
}

std::vector<Break> breaks() {
    return {{"as it is", [](const Surface& s) { return s; }},
            {"holes", holes},
            {"flips", flips},
            {"duplicates", duplicates},
            {"noise", noise, true, false, 0, true},
            {"self-intersection", crossing, true, false, 0, true},
            {"non-manifold edges", fins},
            {"slivers", slivers},
            {"two shells", two_shells, true, true},
            {"huge offset", offset, true, false, far}};
}

}  // namespace palpate::bench
