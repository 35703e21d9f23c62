#include "mesh/core/volume_mesh.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

namespace palpate::mesh {

namespace {

/// The sides of a tetrahedron of positive volume, outward: three corners, then the midsides between them.
constexpr std::array<std::array<int, 6>, 4> sides{
    {{0, 2, 1, 6, 5, 4}, {0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}}};
/// The edges behind the midside nodes, in VTK's order.
constexpr std::array<std::array<int, 2>, 6> tetrahedron_edges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
constexpr std::array<std::array<int, 2>, 3> triangle_edges{{{0, 1}, {1, 2}, {2, 0}}};

std::uint64_t edge_key(int a, int b) {
    const auto [low, high] = std::minmax(a, b);
    return (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint64_t>(high);
}

}  // namespace

Faces boundary_faces(const Tetrahedra& tetrahedra) {
    // Every side of every element, by its corners; those that two elements share stand next to each other.
    struct Side {
        std::array<int, 3> corners;  // ascending
        Eigen::Index element;
        int local;
    };
    std::vector<Side> all;
    all.reserve(static_cast<std::size_t>(4 * tetrahedra.rows()));
    for (Eigen::Index e = 0; e < tetrahedra.rows(); ++e)
        for (int s = 0; s < 4; ++s) {
            std::array<int, 3> corners{};
            for (int c = 0; c < 3; ++c) corners[c] = tetrahedra(e, sides[s][c]);
            std::ranges::sort(corners);
            all.push_back({corners, e, s});
        }
    std::ranges::sort(all, {}, [](const Side& s) { return std::tuple(s.corners, s.element); });

    // Those that stand alone, in the order of the elements.
    std::vector<Side> alone;
    for (std::size_t i = 0, next = 0; i < all.size(); i = next) {
        while (next < all.size() && all[next].corners == all[i].corners) ++next;
        if (next == i + 1) alone.push_back(all[i]);
    }
    std::ranges::sort(alone, {}, [](const Side& s) { return std::pair(s.element, s.local); });

    Faces faces(static_cast<Eigen::Index>(alone.size()), tetrahedra.cols() == 10 ? 6 : 3);
    for (std::size_t i = 0; i < alone.size(); ++i)
        for (int c = 0; c < faces.cols(); ++c)
            faces(static_cast<Eigen::Index>(i), c) = tetrahedra(alone[i].element, sides[alone[i].local][c]);
    return faces;
}

VolumeMesh to_quadratic(const VolumeMesh& mesh) {
    if (mesh.is_quadratic()) return mesh;
    std::unordered_map<std::uint64_t, int> midside;
    std::vector<std::array<int, 2>> ends;  // of the edges behind the new nodes
    const auto corners = static_cast<int>(mesh.nodes.rows());
    const auto node_between = [&](int a, int b) {
        const auto [entry, is_new] = midside.try_emplace(edge_key(a, b), corners + static_cast<int>(ends.size()));
        if (is_new) ends.push_back({a, b});
        return entry->second;
    };

    VolumeMesh result;
    result.tetrahedra.resize(mesh.tetrahedra.rows(), 10);
    result.tetrahedra.leftCols(4) = mesh.tetrahedra;
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e)
        for (int s = 0; s < 6; ++s)
            result.tetrahedra(e, 4 + s) =
                node_between(mesh.tetrahedra(e, tetrahedron_edges[s][0]), mesh.tetrahedra(e, tetrahedron_edges[s][1]));
    result.faces.resize(mesh.faces.rows(), 6);
    if (mesh.faces.rows() > 0) result.faces.leftCols(3) = mesh.faces;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        for (int s = 0; s < 3; ++s)
            result.faces(f, 3 + s) =
                node_between(mesh.faces(f, triangle_edges[s][0]), mesh.faces(f, triangle_edges[s][1]));

    result.nodes.resize(corners + static_cast<Eigen::Index>(ends.size()), 3);
    result.nodes.topRows(corners) = mesh.nodes;
    for (std::size_t i = 0; i < ends.size(); ++i)
        result.nodes.row(corners + static_cast<Eigen::Index>(i)) =
            0.5 * (mesh.nodes.row(ends[i][0]) + mesh.nodes.row(ends[i][1]));
    return result;
}

Eigen::VectorXd element_volumes(const VolumeMesh& mesh) {
    Eigen::VectorXd volumes(mesh.tetrahedra.rows());
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) {
        Mat3 edges;
        for (int c = 0; c < 3; ++c)
            edges.col(c) = mesh.nodes.row(mesh.tetrahedra(e, c + 1)) - mesh.nodes.row(mesh.tetrahedra(e, 0));
        volumes[e] = edges.determinant() / 6;
    }
    return volumes;
}

Surface boundary_surface(const VolumeMesh& mesh, Eigen::VectorXi* node_of_vertex) {
    // Vertices: the nodes of the boundary, in the order of the body's nodes.
    std::vector<int> vertex_of_node(static_cast<std::size_t>(mesh.nodes.rows()), -1);
    for (const int node : mesh.faces.reshaped()) vertex_of_node[static_cast<std::size_t>(node)] = 0;
    std::vector<int> nodes;
    for (std::size_t node = 0; node < vertex_of_node.size(); ++node) {
        if (vertex_of_node[node] < 0) continue;
        vertex_of_node[node] = static_cast<int>(nodes.size());
        nodes.push_back(static_cast<int>(node));
    }

    // A 6-node face: a triangle at each corner, and the one between the midsides.
    std::vector<std::array<int, 3>> cut{{0, 1, 2}};
    if (mesh.faces.cols() == 6) cut = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

    Surface surface;
    surface.vertices = mesh.nodes(nodes, Eigen::all);
    surface.triangles.resize(mesh.faces.rows() * static_cast<Eigen::Index>(cut.size()), 3);
    Eigen::Index t = 0;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        for (const auto& corners : cut) {
            for (int c = 0; c < 3; ++c)
                surface.triangles(t, c) = vertex_of_node[static_cast<std::size_t>(mesh.faces(f, corners[c]))];
            ++t;
        }
    if (node_of_vertex) *node_of_vertex = Eigen::Map<Eigen::VectorXi>(nodes.data(), std::ssize(nodes));
    return surface;
}

VolumeMesh make_bar(const Vec3& min, const Vec3& max, const Eigen::Vector3i& cells) {
    assert((cells.array() > 0).all() && (max - min).minCoeff() > 0);
    const Eigen::Vector3i points = cells.array() + 1;
    const auto lattice = [&](const Eigen::Vector3i& at) {
        return at.x() + points.x() * (at.y() + points.y() * at.z());
    };
    const auto for_each = [](const Eigen::Vector3i& count, const auto& visit) {
        for (Eigen::Vector3i at(0, 0, 0); at.z() < count.z(); ++at.z())
            for (at.y() = 0; at.y() < count.y(); ++at.y())
                for (at.x() = 0; at.x() < count.x(); ++at.x()) visit(at);
    };

    VolumeMesh mesh;
    mesh.nodes.resize(points.prod(), 3);
    for_each(points, [&](const Eigen::Vector3i& at) {
        const Eigen::Array3d share = at.cast<double>().array() / cells.cast<double>().array();
        mesh.nodes.row(lattice(at)) = ((1 - share) * min.array() + share * max.array()).transpose();
    });

    // Six paths along the cell's edges lead from its lowest corner to its highest; each is a tetrahedron. All cells
    // are cut alike, so neighbours agree on the diagonal of their common side.
    constexpr std::array<std::array<int, 3>, 6> paths{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    mesh.tetrahedra.resize(Eigen::Index{6} * cells.prod(), 4);
    Eigen::Index e = 0;
    for_each(cells, [&](const Eigen::Vector3i& at) {
        for (std::size_t p = 0; p < paths.size(); ++p, ++e) {
            Eigen::Vector3i corner = at;
            mesh.tetrahedra(e, 0) = lattice(corner);
            for (int step = 0; step < 3; ++step) {
                ++corner[paths[p][step]];
                mesh.tetrahedra(e, step + 1) = lattice(corner);
            }
            const bool left_handed = p >= 3;  // odd permutations of the axes
            if (left_handed) std::swap(mesh.tetrahedra(e, 1), mesh.tetrahedra(e, 2));
        }
    });
    mesh.faces = boundary_faces(mesh.tetrahedra);
    return mesh;
}

}  // namespace palpate::mesh
