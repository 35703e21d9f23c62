#include "fem/interpolation/refine.h"

#include <array>
#include <cassert>
#include <map>
#include <utility>
#include <vector>

#include "fem/elements/shape.h"

namespace palpate::fem {
namespace {

constexpr int corners = 4, nodes = 10, pieces = 8;
constexpr std::array<std::array<int, 4>, 4> at_corners{{{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}}};
// The octahedron's diagonals join midsides of opposite edges; round each, the other four in order.
constexpr std::array<std::array<int, 2>, 3> diagonals{{{4, 9}, {5, 7}, {6, 8}}};
constexpr std::array<std::array<int, 4>, 3> rounds{{{5, 6, 7, 8}, {4, 6, 9, 8}, {4, 5, 9, 7}}};

using Barycentric = Eigen::Vector4d;
using Pieces = std::array<std::array<int, corners>, pieces>;

Barycentric place_of(int node) {
    if (node < corners) return Barycentric::Unit(node);
    const auto [a, b] = edge_corners[node - corners];
    return 0.5 * (Barycentric::Unit(a) + Barycentric::Unit(b));
}

/// In the element's own coordinates.
bool is_turned_inside_out(const std::array<int, corners>& piece) {
    Eigen::Matrix4d l;
    for (int c = 0; c < corners; ++c) l.col(c) = place_of(piece[c]);
    return l.determinant() < 0;
}

/// The eight pieces, by the element's nodes, for each diagonal.
const std::array<Pieces, 3>& pieces_by_diagonal() {
    static const std::array<Pieces, 3> result = [] {
        std::array<Pieces, 3> all;
        for (std::size_t d = 0; d < all.size(); ++d) {
            std::copy(at_corners.begin(), at_corners.end(), all[d].begin());
            for (int k = 0; k < 4; ++k)
                all[d][4 + k] = {diagonals[d][0], diagonals[d][1], rounds[d][k], rounds[d][(k + 1) % 4]};
            for (auto& piece : all[d])
                if (is_turned_inside_out(piece)) std::swap(piece[2], piece[3]);
        }
        return all;
    }();
    return result;
}

}  // namespace

RefinedMesh refine(const mesh::VolumeMesh& body) {
    assert(body.is_quadratic());
    std::vector<Eigen::Triplet<double>> weights;
    weights.reserve(60 * body.nodes.rows());  // about eight nodes for one, of ten weights or less
    for (int n = 0; n < body.nodes.rows(); ++n) weights.emplace_back(n, n, 1);
    auto count = static_cast<int>(body.nodes.rows());
    std::map<std::pair<int, int>, int> middles;  // of the edges of pieces

    RefinedMesh result;
    Tetrahedra& fine = result.mesh.tetrahedra;
    fine.resize(pieces * body.tetrahedra.rows(), nodes);
    for (Eigen::Index e = 0; e < body.tetrahedra.rows(); ++e) {
        const auto element = body.tetrahedra.row(e);
        const auto length = [&](const std::array<int, 2>& ends) {
            return (body.nodes.row(element[ends[0]]) - body.nodes.row(element[ends[1]])).norm();
        };
        std::size_t shortest = 0;
        for (std::size_t d = 1; d < diagonals.size(); ++d)
            if (length(diagonals[d]) < length(diagonals[shortest])) shortest = d;
        for (int p = 0; p < pieces; ++p) {
            const std::array<int, corners>& piece = pieces_by_diagonal()[shortest][p];
            for (int c = 0; c < corners; ++c) fine(pieces * e + p, c) = element[piece[c]];
            for (int k = 0; k < 6; ++k) {
                const int a = piece[edge_corners[k][0]], b = piece[edge_corners[k][1]];
                const auto [middle, is_new] = middles.try_emplace(
                    std::minmax({static_cast<int>(element[a]), static_cast<int>(element[b])}), count);
                fine(pieces * e + p, corners + k) = middle->second;
                if (!is_new) continue;
                const auto N = shape<corners, nodes>(0.5 * (place_of(a) + place_of(b)));
                for (int i = 0; i < nodes; ++i)
                    if (N(i) != 0) weights.emplace_back(count, element[i], N(i));
                ++count;
            }
        }
    }
    result.interpolation.resize(count, body.nodes.rows());
    result.interpolation.setFromTriplets(weights.begin(), weights.end());
    result.mesh.nodes = result.interpolation * body.nodes;
    result.mesh.faces = mesh::boundary_faces(fine);
    return result;
}

}  // namespace palpate::fem
