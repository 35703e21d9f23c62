#include "mesh/meshing/follow_borders.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "mesh/geometry/closest_within.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::mesh {
namespace {

// Shares of an edge, from the node that is closer to the border.
constexpr double negligible = 0.02;  // of a bar of 14 elements: it bends with length^3, so by 0.4 % otherwise
constexpr double rounding = 1e-5;    // borders belong to a region a little beyond what was written
constexpr double flattest = 0.001;   // element that a cut may leave outside
constexpr double close = 0.3;        // a longer move flattens elements behind the node, a cut so near those before it

constexpr double worst_allowed = 0.1;        // of an element that a move leaves: a tenth of a regular one's; that a
                                             // cut off the edge leaves: of one on it
constexpr double largest_turn = 15;          // of a way off the triangles it leads over [degrees]: no crease is lost
constexpr double largest_off_surface = 0.1;  // of an edge: further off, the nearest point may lie on another side

using Tetrahedron = std::array<int, 4>;

/// 6 sqrt(2) V / (root mean square edge)^3: 1 for a regular one, negative for one that is turned inside out.
double quality(const std::array<Vec3, 4>& corners) {
    Mat3 edges;
    double squares = 0;
    for (int i = 0; i < 4; ++i) {
        if (i > 0) edges.col(i - 1) = corners[i] - corners[0];
        for (int j = i + 1; j < 4; ++j) squares += (corners[i] - corners[j]).squaredNorm();
    }
    return std::sqrt(2.0) * edges.determinant() / std::pow(squares / 6, 1.5);
}

/// An edge that runs from within the regions to outside.
struct Crossing {
    int within, outside;  // nodes
    Vec3 point;           // on the border, still within [mm]
    double share;         // of the edge that is within
    double length;        // of the edge [mm]
};

class Follower {
public:
    Follower(const VolumeMesh& body, const std::vector<Region>& regions, const Surface& surface,
             const std::vector<char>& fixed)
        : surface_(surface), regions_(with_borders(regions)), fixed_(fixed) {
        const std::vector<char> is_held = contains(regions, body.nodes);
        for (Eigen::Index n = 0; n < body.nodes.rows(); ++n) nodes_.emplace_back(body.nodes.row(n));
        const std::size_t nodes = nodes_.size();
        is_within_ = contains(regions_, body.nodes);
        is_on_.assign(nodes, 0);
        for (std::size_t n = 0; n < nodes; ++n) is_on_[n] = is_held[n] && !is_within_[n];  // by points
        fixed_.resize(nodes, 0);
        elements_of_.resize(nodes);
        triangles_of_.resize(nodes);
        for (Eigen::Index e = 0; e < body.tetrahedra.rows(); ++e) {
            Tetrahedron corners{};
            for (int c = 0; c < 4; ++c) {
                corners[c] = body.tetrahedra(e, c);
                elements_of_[corners[c]].push_back(static_cast<int>(e));
            }
            elements_.push_back(corners);
        }
        for (Eigen::Index f = 0; f < body.faces.rows(); ++f) {
            std::array<int, 3> corners{};
            for (int c = 0; c < 3; ++c) {
                corners[c] = body.faces(f, c);
                triangles_of_[corners[c]].push_back(static_cast<int>(f));
                boundary_edges_.insert(edge_of(body.faces(f, c), body.faces(f, (c + 1) % 3)));
            }
            triangles_.push_back(corners);
        }
    }

    /// Whether anything was changed.
    bool follow() {
        const bool moved = move_near_nodes();
        std::vector<Crossing> crossings = find_crossings();
        std::erase_if(crossings, [](const Crossing& c) { return c.share > 1 - flattest; });
        std::ranges::sort(crossings, [](const Crossing& a, const Crossing& b) {
            return std::tuple(-a.length, a.within, a.outside) < std::tuple(-b.length, b.within, b.outside);
        });
        for (const Crossing& crossing : crossings) cut(crossing);
        return moved || !crossings.empty();
    }

    VolumeMesh result() const {
        VolumeMesh body;
        body.tetrahedra.resize(std::ssize(elements_), 4);
        for (std::size_t e = 0; e < elements_.size(); ++e)
            for (int c = 0; c < 4; ++c) body.tetrahedra(static_cast<Eigen::Index>(e), c) = elements_[e][c];
        std::vector<char> is_inner(nodes_.size(), 1);
        body.faces = boundary_faces(body.tetrahedra);
        for (const int node : body.faces.reshaped()) is_inner[node] = 0;
        std::vector<int> order(nodes_.size()), place(nodes_.size());
        std::iota(order.begin(), order.end(), 0);
        std::ranges::stable_sort(order, {}, [&](int node) { return is_inner[node]; });
        body.nodes.resize(std::ssize(nodes_), 3);
        for (std::size_t i = 0; i < order.size(); ++i) {
            place[order[i]] = static_cast<int>(i);
            body.nodes.row(static_cast<Eigen::Index>(i)) = nodes_[order[i]];
        }
        for (int& node : body.tetrahedra.reshaped()) node = place[node];
        for (int& node : body.faces.reshaped()) node = place[node];
        return body;
    }

private:
    using Edge = std::pair<int, int>;

    static Edge edge_of(int a, int b) { return std::minmax(a, b); }

    std::vector<Crossing> find_crossings() const {
        std::set<Edge> seen;
        std::vector<Crossing> crossings;
        for (const Tetrahedron& corners : elements_)
            for (const int a : corners)
                for (const int b : corners)
                    if (crosses(a, b) && seen.insert({a, b}).second) crossings.push_back(crossing_of(a, b));
        return crossings;
    }

    bool crosses(int within, int outside) const {
        return is_within_[within] && !is_on_[within] && !is_within_[outside] && !is_on_[outside];
    }

    Crossing crossing_of(int within, int outside) const {
        const Vec3 start = nodes_[within], edge = nodes_[outside] - start;
        const bool is_on_boundary = boundary_edges_.contains(edge_of(within, outside));
        const auto point_at = [&](double share) -> Vec3 {
            const Vec3 chord = start + share * edge;
            if (!is_on_boundary) return chord;
            const SurfacePoint nearest = surface_.closest(chord);
            return nearest.distance < largest_off_surface * edge.norm() ? nearest.position : chord;
        };
        double in = 0, out = 1;
        for (int i = 0; i < 50; ++i) {
            const double middle = 0.5 * (in + out);
            (contains(regions_, point_at(middle)) ? in : out) = middle;
        }
        // Exactly on it: what lies between such points is within, too.
        return {within, outside, closest_within(regions_, point_at(in)), in, edge.norm()};
    }

    /// Moves nodes onto the border, the shortest ways first. Those within that may not be moved and are next to it
    /// count as being on it.
    bool move_near_nodes() {
        struct Way {
            int node;
            Vec3 to;
            double share, length;
        };
        std::vector<Way> ways;
        for (const Crossing& c : find_crossings()) {
            const bool is_on_boundary = boundary_edges_.contains(edge_of(c.within, c.outside));
            const auto allow = [&](int node, double share) {
                const bool is_there = is_within_[node] && share < rounding;
                const bool may_move = !is_there && !fixed_[node] && (triangles_of_[node].empty() || is_on_boundary);
                if (share < close && (may_move || share < negligible))
                    ways.push_back({node, may_move ? c.point : nodes_[node], share, share * c.length});
            };
            allow(c.within, c.share);
            allow(c.outside, 1 - c.share);
        }
        std::ranges::sort(ways, [](const Way& a, const Way& b) {
            return std::tuple(a.length, a.node) < std::tuple(b.length, b.node);
        });
        bool moved = false;
        for (const Way& way : ways) {
            if (is_on_[way.node] || !has_crossing(way.node)) continue;
            const bool arrives = way.to != nodes_[way.node] && move(way.node, way.to);
            moved = moved || arrives;
            if (arrives || (is_within_[way.node] && way.share < negligible)) {
                is_within_[way.node] = 1;
                is_on_[way.node] = 1;
            }
        }
        return moved;
    }

    bool has_crossing(int node) const {
        return std::ranges::any_of(elements_of_[node], [&](int e) {
            return std::ranges::any_of(elements_[e],
                                       [&](int other) { return crosses(node, other) || crosses(other, node); });
        });
    }

    /// Moves a node, unless elements or the surface would suffer.
    bool move(int node, const Vec3& to) {
        const Vec3 from = nodes_[node];
        std::vector<double> qualities;
        for (const int e : elements_of_[node]) qualities.push_back(quality(corners_of(elements_[e])));
        std::vector<Vec3> normals;
        for (const int t : triangles_of_[node]) normals.push_back(normal_of(t));
        nodes_[node] = to;
        const Vec3 way = (nodes_[node] - from).normalized();
        bool suffers = std::ranges::any_of(
            normals, [&](const Vec3& n) { return std::abs(n.dot(way)) > std::sin(largest_turn * M_PI / 180); });
        for (std::size_t i = 0; i < qualities.size(); ++i)
            suffers |=
                quality(corners_of(elements_[elements_of_[node][i]])) < std::min(worst_allowed, 0.5 * qualities[i]);
        if (suffers) nodes_[node] = from;
        return !suffers;
    }

    std::array<Vec3, 4> corners_of(const Tetrahedron& element) const {
        return {nodes_[element[0]], nodes_[element[1]], nodes_[element[2]], nodes_[element[3]]};
    }

    Vec3 normal_of(int triangle) const {
        const auto& [a, b, c] = triangles_[triangle];
        return (nodes_[b] - nodes_[a]).cross(nodes_[c] - nodes_[a]).normalized();
    }

    /// Cuts an edge, and with it all elements around it.
    void cut(const Crossing& crossing) {
        const int a = crossing.within, b = crossing.outside, middle = static_cast<int>(nodes_.size());
        std::vector<int> around;
        std::ranges::copy_if(elements_of_[a], std::back_inserter(around),
                             [&](int e) { return std::ranges::find(elements_[e], b) != elements_[e].end(); });
        const auto parts_by = [&](const Vec3& point) {  // qualities
            nodes_[middle] = point;
            std::vector<double> qualities;
            for (const int e : around)
                for (const int end : {a, b}) qualities.push_back(quality(corners_of(with(elements_[e], end, middle))));
            return qualities;
        };
        // Where a surface curves so much that elements would become flat, on the edge itself.
        nodes_.emplace_back();
        const Vec3 on_edge = nodes_[a] + crossing.share * (nodes_[b] - nodes_[a]);
        const std::vector<double> straight = parts_by(on_edge), curved = parts_by(crossing.point);
        const bool is_sound = std::ranges::equal(
            curved, straight, [](double part, double least) { return part > worst_allowed * least; });
        if (!is_sound) nodes_[middle] = on_edge;
        is_within_.push_back(1);
        is_on_.push_back(1);
        elements_of_.emplace_back();
        for (const int e : around) {
            const int added = static_cast<int>(elements_.size());
            const Tetrahedron before = elements_[e];
            elements_.push_back(with(before, a, middle));
            elements_[e] = with(before, b, middle);
            std::erase(elements_of_[b], e);
            for (const int node : before)
                if (node != a) elements_of_[node].push_back(added);
            elements_of_[middle].insert(elements_of_[middle].end(), {e, added});
        }
    }

    static Tetrahedron with(Tetrahedron element, int node, int replaced_by) {
        std::ranges::replace(element, node, replaced_by);
        return element;
    }

    SurfaceTree surface_;
    std::vector<Region> regions_;
    std::vector<Vec3> nodes_;
    std::vector<char> fixed_, is_within_, is_on_;  // of nodes; on: on a border, or not to be parted from what is held
    std::vector<Tetrahedron> elements_;
    std::vector<std::array<int, 3>> triangles_;  // of the boundary, as it was given
    std::set<Edge> boundary_edges_;
    std::vector<std::vector<int>> elements_of_, triangles_of_;  // of each node
};

}  // namespace

VolumeMesh follow_borders(const VolumeMesh& body, const std::vector<Region>& regions, const Surface& surface,
                          const std::vector<char>& fixed) {
    if (with_borders(regions).empty()) return body;
    Follower follower(body, regions, surface, fixed);
    return follower.follow() ? follower.result() : body;
}

}  // namespace palpate::mesh
