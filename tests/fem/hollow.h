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

/// A spherical shell of quadratic, curved elements: an octahedron's faces cut in four `cuts` times, in layers.
inline mesh::VolumeMesh spherical_shell(double inner, double outer, int layers, int cuts) {
    std::vector<Vec3> corners{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<std::array<int, 3>> triangles;
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

    // Prisms in three, cut by the order of their corners, so that neighbours agree.
    const int n = static_cast<int>(corners.size());
    mesh::VolumeMesh shell;
    shell.nodes.resize(Eigen::Index{n} * (layers + 1), 3);
    for (int k = 0; k <= layers; ++k) {
        const double r = inner + (outer - inner) * k / layers;
        for (int i = 0; i < n; ++i) shell.nodes.row(Eigen::Index{k} * n + i) = r * corners[i];
    }
    shell.tetrahedra.resize(static_cast<Eigen::Index>(3 * triangles.size()) * layers, 4);
    Eigen::Index e = 0;
    for (int k = 0; k < layers; ++k) {
        for (auto [a, b, c] : triangles) {
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
    const Eigen::VectorXd volumes = mesh::element_volumes(shell);
    for (e = 0; e < volumes.size(); ++e) {
        if (volumes(e) < 0) std::swap(shell.tetrahedra(e, 0), shell.tetrahedra(e, 1));
    }
    shell.faces = mesh::boundary_faces(shell.tetrahedra);
    const Eigen::Index straight = shell.nodes.rows();
    shell = mesh::to_quadratic(shell);
    // Midsides move out to the radius between their ends'.
    for (e = 0; e < shell.tetrahedra.rows(); ++e) {
        constexpr int ends[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
        for (int m = 0; m < 6; ++m) {
            const int node = shell.tetrahedra(e, 4 + m);
            if (node < straight) continue;
            const double r = (shell.nodes.row(shell.tetrahedra(e, ends[m][0])).norm() +
                              shell.nodes.row(shell.tetrahedra(e, ends[m][1])).norm()) /
                             2;
            shell.nodes.row(node) *= r / shell.nodes.row(node).norm();
        }
    }
    return shell;
}

}  // namespace palpate::fem
