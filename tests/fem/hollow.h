#pragma once

#include <algorithm>
#include <map>

#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// A bar [0, size] of quadratic elements, of which the cells at `holes` are left out.
inline mesh::VolumeMesh hollow_bar(const Vec3& size, const Eigen::Vector3i& cells,
                                   const std::vector<Eigen::Vector3i>& holes) {
    mesh::VolumeMesh bar = mesh::make_bar(Vec3::Zero(), size, cells);
    std::vector<int> kept;
    for (int e = 0; e < bar.tetrahedra.rows(); ++e) {
        const Vec3 centre = bar.nodes(bar.tetrahedra.row(e), Eigen::all).colwise().mean();
        const Eigen::Vector3i cell = centre.cwiseQuotient(size).cwiseProduct(cells.cast<double>()).cast<int>();
        if (std::ranges::find(holes, cell) == holes.end()) kept.push_back(e);
    }
    // Nodes that are left in no element go, too.
    Tetrahedra tetrahedra = bar.tetrahedra(kept, Eigen::all);
    std::map<int, int> number;
    std::vector<int> nodes;
    for (Eigen::Index k = 0; k < tetrahedra.size(); ++k) {
        const auto [at, fresh] = number.try_emplace(tetrahedra.data()[k], static_cast<int>(nodes.size()));
        if (fresh) nodes.push_back(at->first);
        tetrahedra.data()[k] = at->second;
    }
    const Points points = bar.nodes(nodes, Eigen::all);
    return mesh::to_quadratic({points, tetrahedra, mesh::boundary_faces(tetrahedra)});
}

/// Triangles on a sphere of radius 1: an octahedron's faces, cut in four `cuts` times.
struct SphereTriangles {
    std::vector<Vec3> corners{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<std::array<int, 3>> triangles;

    explicit SphereTriangles(int cuts) {
        for (const int x : {0, 1})
            for (const int y : {2, 3})
                for (const int z : {4, 5}) triangles.push_back({x, y, z});
        for (int cut = 0; cut < cuts; ++cut) {
            std::map<std::array<int, 2>, int> middle;
            const auto between = [&](int a, int b) {
                const auto [at, fresh] =
                    middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(corners.size()));
                if (fresh) corners.push_back((corners[a] + corners[b]).normalized());
                return at->second;
            };
            std::vector<std::array<int, 3>> finer;
            for (const auto& [a, b, c] : triangles) {
                const int ab = between(a, b), bc = between(b, c), ca = between(c, a);
                for (const auto& part : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
                    finer.push_back(part);
            }
            triangles = finer;
        }
    }
};

/// Quadratic elements out of straight ones, whose midsides move out to the radius between their ends'.
inline mesh::VolumeMesh rounded(mesh::VolumeMesh body) {
    const Eigen::VectorXd volumes = mesh::element_volumes(body);
    for (Eigen::Index e = 0; e < volumes.size(); ++e) {
        if (volumes(e) < 0) std::swap(body.tetrahedra(e, 0), body.tetrahedra(e, 1));
    }
    body.faces = mesh::boundary_faces(body.tetrahedra);
    const Eigen::Index straight = body.nodes.rows();
    body = mesh::to_quadratic(body);
    for (Eigen::Index e = 0; e < body.tetrahedra.rows(); ++e) {
        constexpr int ends[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
        for (int m = 0; m < 6; ++m) {
            const int node = body.tetrahedra(e, 4 + m);
            if (node < straight) continue;
            const double r = (body.nodes.row(body.tetrahedra(e, ends[m][0])).norm() +
                              body.nodes.row(body.tetrahedra(e, ends[m][1])).norm()) /
                             2;
            body.nodes.row(node) *= r / body.nodes.row(node).norm();
        }
    }
    return body;
}

/// Straight elements of a spherical shell in layers, from the inside out; faces are left out.
inline mesh::VolumeMesh straight_shell(const SphereTriangles& sphere, double inner, double outer, int layers) {
    // Prisms in three, cut by the order of their corners, so that neighbours agree.
    const int n = static_cast<int>(sphere.corners.size());
    mesh::VolumeMesh shell;
    shell.nodes.resize(Eigen::Index{n} * (layers + 1), 3);
    for (int k = 0; k <= layers; ++k) {
        const double r = inner + (outer - inner) * k / layers;
        for (int i = 0; i < n; ++i) shell.nodes.row(Eigen::Index{k} * n + i) = r * sphere.corners[i];
    }
    shell.tetrahedra.resize(static_cast<Eigen::Index>(3 * sphere.triangles.size()) * layers, 4);
    Eigen::Index e = 0;
    for (int k = 0; k < layers; ++k) {
        for (auto [a, b, c] : sphere.triangles) {
            std::array sorted{a, b, c};
            std::ranges::sort(sorted);
            const auto& [i, j, l] = sorted;
            const int low = k * n, high = low + n;
            for (const auto& part : {std::array{low + i, low + j, low + l, high + l},
                                     {low + i, low + j, high + l, high + j},
                                     {low + i, high + j, high + l, high + i}}) {
                for (int m = 0; m < 4; ++m) shell.tetrahedra(e, m) = part[m];
                ++e;
            }
        }
    }
    return shell;
}

/// A spherical shell of quadratic, curved elements.
inline mesh::VolumeMesh spherical_shell(double inner, double outer, int layers, int cuts) {
    return rounded(straight_shell(SphereTriangles(cuts), inner, outer, layers));
}

/// A ball of quadratic, curved elements: layers round a core, whose elements meet in the middle.
inline mesh::VolumeMesh ball(double radius, int layers, int cuts) {
    const SphereTriangles sphere(cuts);
    mesh::VolumeMesh body = straight_shell(sphere, radius / (layers + 1), radius, layers);
    const auto middle = static_cast<int>(body.nodes.rows());
    body.nodes.conservativeResize(middle + 1, 3);
    body.nodes.row(middle).setZero();
    Eigen::Index e = body.tetrahedra.rows();
    body.tetrahedra.conservativeResize(e + static_cast<Eigen::Index>(sphere.triangles.size()), 4);
    for (const auto& [a, b, c] : sphere.triangles) body.tetrahedra.row(e++) << a, b, c, middle;
    return rounded(body);
}

}  // namespace palpate::fem
