#include "skeleton/construction/shape/tet_graph.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <queue>
#include <utility>

#include "mesh/errors.h"

namespace palpate::skeleton {
namespace {

// Corners of the face opposite to each corner, counter-clockwise seen from outside.
constexpr int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

double volume(const Points& x, const std::array<int, 4>& t) {
    const Vec3 a = x.row(t[0]);
    return (Vec3(x.row(t[1])) - a).cross(Vec3(x.row(t[2])) - a).dot(Vec3(x.row(t[3])) - a) / 6;
}

// Red refinement: four tetrahedra at the corners, four round the shortest diagonal of the octahedron between them.
void split(Points& nodes, TetGraph::Quads& corners) {
    std::map<std::pair<int, int>, int> middles;
    std::vector<Vec3> added;
    const auto middle = [&](int a, int b) {
        const auto [found, fresh] = middles.try_emplace(std::minmax(a, b), nodes.rows() + added.size());
        if (fresh) added.push_back((nodes.row(a) + nodes.row(b)) / 2);
        return found->second;
    };
    std::vector<std::array<int, 4>> pieces;
    std::vector<std::array<int, 6>> octahedra;
    for (Eigen::Index t = 0; t < corners.rows(); ++t) {
        const int a = corners(t, 0), b = corners(t, 1), c = corners(t, 2), d = corners(t, 3);
        const int ab = middle(a, b), ac = middle(a, c), ad = middle(a, d);
        const int bc = middle(b, c), bd = middle(b, d), cd = middle(c, d);
        pieces.insert(pieces.end(), {{a, ab, ac, ad}, {ab, b, bc, bd}, {ac, bc, c, cd}, {ad, bd, cd, d}});
        octahedra.push_back({ab, cd, ac, bd, ad, bc});  // opposite corners side by side
    }
    const Eigen::Index old = nodes.rows();
    nodes.conservativeResize(old + static_cast<Eigen::Index>(added.size()), 3);
    for (std::size_t i = 0; i < added.size(); ++i) nodes.row(old + static_cast<Eigen::Index>(i)) = added[i];

    for (auto o : octahedra) {
        const auto length = [&](int i) { return (nodes.row(o[i]) - nodes.row(o[i + 1])).norm(); };
        for (int i : {2, 4}) {
            if (length(i) >= length(0)) continue;
            std::swap(o[0], o[i]);
            std::swap(o[1], o[i + 1]);
        }
        const int ring[5] = {o[2], o[4], o[3], o[5], o[2]};
        for (int i = 0; i < 4; ++i) {
            std::array<int, 4> piece{o[0], o[1], ring[i], ring[i + 1]};
            if (volume(nodes, piece) < 0) std::swap(piece[2], piece[3]);
            pieces.push_back(piece);
        }
    }
    corners.resize(static_cast<Eigen::Index>(pieces.size()), 4);
    for (std::size_t t = 0; t < pieces.size(); ++t) {
        for (int c = 0; c < 4; ++c) corners(static_cast<Eigen::Index>(t), c) = pieces[t][c];
    }
}

// Two tetrahedra are neighbours when they have a face's three nodes in common.
TetGraph::Quads find_neighbors(const TetGraph& graph) {
    struct Face {
        std::array<int, 3> nodes;
        int tet, corner;
    };
    std::vector<Face> all;
    all.reserve(4 * graph.corners.rows());
    for (int t = 0; t < graph.size(); ++t) {
        for (int c = 0; c < 4; ++c) {
            auto nodes = graph.face_nodes(t, c);
            std::sort(nodes.begin(), nodes.end());
            all.push_back({nodes, t, c});
        }
    }
    std::sort(all.begin(), all.end(), [](const Face& p, const Face& q) { return p.nodes < q.nodes; });

    TetGraph::Quads neighbors = TetGraph::Quads::Constant(graph.size(), 4, -1);
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        const Face &p = all[i], &q = all[i + 1];
        if (p.nodes != q.nodes) continue;
        neighbors(p.tet, p.corner) = q.tet;
        neighbors(q.tet, q.corner) = p.tet;
    }
    return neighbors;
}

}  // namespace

std::array<int, 3> TetGraph::face_nodes(int tet, int corner) const {
    return {corners(tet, faces[corner][0]), corners(tet, faces[corner][1]), corners(tet, faces[corner][2])};
}

Vec3 TetGraph::face_area(int tet, int corner) const {
    const Vec3 a = node(tet, faces[corner][0]);
    return (node(tet, faces[corner][1]) - a).cross(node(tet, faces[corner][2]) - a) / 2;
}

TetGraph make_tet_graph(const mesh::VolumeMesh& body, int least) {
    TetGraph graph;
    graph.nodes = body.nodes;
    graph.corners = body.tetrahedra.leftCols(4);
    if (graph.size() == 0) throw InvalidInput("the body has no tetrahedra: mesh its surface first");
    while (graph.size() < least) split(graph.nodes, graph.corners);
    graph.neighbors = find_neighbors(graph);

    graph.centers.resize(graph.size(), 3);
    graph.volumes.resize(graph.size());
    for (int t = 0; t < graph.size(); ++t) {
        const auto c = graph.corners.row(t);
        graph.centers.row(t) = (graph.node(t, 0) + graph.node(t, 1) + graph.node(t, 2) + graph.node(t, 3)) / 4;
        graph.volumes(t) = volume(graph.nodes, {c(0), c(1), c(2), c(3)});
    }

    const std::vector<char> together = walk(graph, [](int, int) {});
    const auto apart = std::find(together.begin(), together.end(), 0);
    if (apart != together.end()) {
        const Vec3 at = graph.centers.row(apart - together.begin());
        throw InvalidInput(
            fmt::format("the body is in several pieces, one of them near ({:.4g}, {:.4g}, {:.4g}) mm: "
                        "a skeleton is made for one piece, so join them or keep one",
                        at.x(), at.y(), at.z()));
    }
    return graph;
}

Eigen::VectorXd path_lengths(const TetGraph& graph, const Points& at, const std::vector<int>& from) {
    using Entry = std::pair<double, int>;
    Eigen::VectorXd length = Eigen::VectorXd::Constant(graph.size(), std::numeric_limits<double>::infinity());
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
    for (int t : from) {
        length(t) = 0;
        front.emplace(0., t);
    }
    while (!front.empty()) {
        const auto [d, t] = front.top();
        front.pop();
        if (d > length(t)) continue;
        for (int c = 0; c < 4; ++c) {
            const int u = graph.neighbors(t, c);
            if (u < 0) continue;
            const double further = d + (at.row(u) - at.row(t)).norm();
            if (further >= length(u)) continue;
            length(u) = further;
            front.emplace(further, u);
        }
    }
    return length;
}

}  // namespace palpate::skeleton
