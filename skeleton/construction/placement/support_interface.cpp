#include "skeleton/construction/placement/support_interface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "mesh/errors.h"

namespace palpate::skeleton {
namespace {

std::string words(const Vec3& p) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x(), p.y(), p.z()); }

std::string words(const mesh::Region& region) {
    struct Words {
        std::string operator()(const mesh::BoxRegion& r) const {
            return fmt::format("a box from {} to {} mm", words(r.min), words(r.max));
        }
        std::string operator()(const mesh::SphereRegion& r) const {
            return fmt::format("a sphere of radius {:.4g} mm round {} mm", r.radius, words(r.center));
        }
        std::string operator()(const mesh::PlaneRegion& r) const {
            return fmt::format("all within {:.4g} mm of a plane through {} mm, normal {}", r.within, words(r.point),
                               words(r.normal));
        }
        std::string operator()(const mesh::PointsRegion& r) const {
            if (r.points.rows() == 0) return "a list of no points";
            const mesh::Box box = mesh::bounding_box(r.points);
            return fmt::format("all within {:.4g} mm of {} points from {} to {} mm", r.within, r.points.rows(),
                               words(box.min), words(box.max));
        }
    };
    return std::visit(Words{}, region);
}

std::string where(const TetGraph& graph, const std::vector<mesh::Region>& supports) {
    const mesh::Box box = mesh::bounding_box(graph.nodes);
    std::string text = fmt::format("the body reaches from {} to {} mm", words(box.min), words(box.max));
    for (std::size_t i = 0; i < supports.size(); ++i)
        text += fmt::format("; support {}: {}", i + 1, words(supports[i]));
    return text;
}

void add(SupportInterface& interface, const Vec3& point, int tet, double area) {
    const Eigen::Index k = interface.patch.rows();
    interface.patch.conservativeResize(k + 1, 3);
    interface.weight.conservativeResize(k + 1);
    interface.patch.row(k) = point;
    interface.weight(k) = area;
    interface.behind.push_back(tet);
}

void add_faces(const TetGraph& graph, SupportInterface& interface) {
    for (int t = 0; t < graph.size(); ++t) {
        if (interface.held[t]) continue;
        for (int c = 0; c < 4; ++c) {
            const auto nodes = graph.face_nodes(t, c);
            const int u = graph.neighbors(t, c);
            const auto holds = [&](int node) { return interface.held_node[node] != 0; };
            if (u >= 0 ? !interface.held[u] : !std::all_of(nodes.begin(), nodes.end(), holds)) continue;
            const Vec3 middle = (graph.nodes.row(nodes[0]) + graph.nodes.row(nodes[1]) + graph.nodes.row(nodes[2])) / 3;
            add(interface, middle, u >= 0 ? u : t, graph.face_area(t, c).norm());
        }
    }
}

// Where only single nodes or edges are held.
void add_nodes(const TetGraph& graph, SupportInterface& interface) {
    std::set<int> done;
    for (int t = 0; t < graph.size(); ++t) {
        for (int c = 0; c < 4; ++c) {
            const int node = graph.corners(t, c);
            if (interface.held_node[node] && done.insert(node).second) add(interface, graph.nodes.row(node), t, 1.);
        }
    }
}

// The nearest row, and how far it is.
std::pair<int, double> nearest_row(const Points& centers, const Eigen::RowVector3d& point) {
    Eigen::Index row = 0;
    const double squared = (centers.rowwise() - point).rowwise().squaredNorm().minCoeff(&row);
    return {static_cast<int>(row), std::sqrt(squared)};
}

// Centres among weighted points, so many that each point is within its reach of one; each new one starts at the
// furthest point, then all go to the middles of what is nearest to them.
Points spread(const Points& points, const Eigen::VectorXd& weights, double reach) {
    Points centers = (weights.transpose() * points) / weights.sum();
    while (centers.rows() < points.rows()) {
        Eigen::Index furthest = 0;
        double distance = 0;
        for (Eigen::Index i = 0; i < points.rows(); ++i) {
            const double d = nearest_row(centers, points.row(i)).second;
            if (d <= distance) continue;
            distance = d;
            furthest = i;
        }
        if (distance < reach) break;
        centers.conservativeResize(centers.rows() + 1, 3);
        centers.bottomRows(1) = points.row(furthest);
        for (int round = 0; round < 10; ++round) {
            Points sum = Points::Zero(centers.rows(), 3);
            Eigen::VectorXd weight = Eigen::VectorXd::Zero(centers.rows());
            for (Eigen::Index i = 0; i < points.rows(); ++i) {
                const int k = nearest_row(centers, points.row(i)).first;
                sum.row(k) += weights(i) * points.row(i);
                weight(k) += weights(i);
            }
            for (Eigen::Index k = 0; k < centers.rows(); ++k) {
                if (weight(k) > 0) centers.row(k) = sum.row(k) / weight(k);
            }
        }
    }
    return centers;
}

}  // namespace

SupportInterface find_support_interface(const TetGraph& graph, const std::vector<mesh::Region>& supports) {
    SupportInterface interface;
    interface.patch.resize(0, 3);
    interface.held_node = mesh::contains(supports, graph.nodes);
    const auto count = std::count(interface.held_node.begin(), interface.held_node.end(), 1);
    if (count == 0) {
        throw InvalidInput(fmt::format("the supports hold nothing of the body: {}. Move or enlarge a support",
                                       supports.empty() ? "none is given" : where(graph, supports)));
    }
    interface.held.resize(graph.size());
    for (int t = 0; t < graph.size(); ++t) {
        const auto nodes = graph.corners.row(t);
        interface.held[t] = std::all_of(nodes.begin(), nodes.end(), [&](int n) { return interface.held_node[n] != 0; });
    }
    if (std::all_of(interface.held.begin(), interface.held.end(), [](char h) { return h != 0; })) {
        throw InvalidInput(
            fmt::format("the supports hold the whole body, nothing is left to move: {}. Make the "
                        "supports smaller",
                        where(graph, supports)));
    }
    add_faces(graph, interface);
    if (interface.patch.rows() == 0) add_nodes(graph, interface);
    return interface;
}

void hold_faces_of_plates(const TetGraph& graph, const Core& core, SupportInterface& interface) {
    std::vector<int> standing;
    for (int t = 0; t < graph.size(); ++t) {
        if (interface.held[t]) continue;
        const Neighborhood& around = core.of(t);
        for (int c = 0; c < 4; ++c) {
            const auto nodes = graph.face_nodes(t, c);
            const auto holds = [&](int node) { return interface.held_node[node] != 0; };
            if (graph.neighbors(t, c) >= 0 || !std::all_of(nodes.begin(), nodes.end(), holds)) continue;
            const Vec3 middle = (graph.nodes.row(nodes[0]) + graph.nodes.row(nodes[1]) + graph.nodes.row(nodes[2])) / 3;
            const Vec3 to_core = around.collapse(middle) - middle;
            if (std::abs(to_core.dot(graph.face_area(t, c).normalized())) < 0.5 * around.radius) continue;
            standing.push_back(t);
            break;
        }
    }
    const auto held = std::count(interface.held.begin(), interface.held.end(), 1);
    if (held + std::ssize(standing) >= graph.size() / 2) return;  // something must be left to move
    for (const int t : standing) interface.held[t] = 1;
}

std::vector<Site> interface_sites(const Core& core, const SupportInterface& interface, double spacing) {
    const Eigen::Index n = interface.patch.rows();
    Points at(n, 3);                 // on the core
    double thin = 0, thickness = 0;  // of the patch: what holds limbs and plates
    for (Eigen::Index i = 0; i < n; ++i) {
        const Neighborhood& around = core.of(interface.behind[i]);
        at.row(i) = around.collapse(interface.patch.row(i));
        if (around.dimensions == 3) continue;
        thin += interface.weight(i);
        thickness += interface.weight(i) * 2 * around.radius;
    }
    // Half a diagonal and some. Close spheres in a chain need no crowd to hold them.
    const double width = thin > 0.5 * interface.weight.sum() ? thickness / thin : 0;
    const Points centers = spread(at, interface.weight, 0.85 * std::max(spacing, width));

    // Each stands in the middle of its part of the patch, and grows from a tetrahedron of its own there.
    std::vector<int> part(n);
    for (Eigen::Index i = 0; i < n; ++i) part[i] = nearest_row(centers, at.row(i)).first;
    std::vector<Site> sites;
    std::set<int> taken;
    for (int k = 0; k < centers.rows(); ++k) {
        Vec3 middle = Vec3::Zero();
        double weight = 0;
        for (Eigen::Index i = 0; i < n; ++i) {
            if (part[i] != k) continue;
            middle += interface.weight(i) * interface.patch.row(i).transpose();
            weight += interface.weight(i);
        }
        if (!(weight > 0)) continue;
        middle /= weight;
        int best = -1;
        double least = std::numeric_limits<double>::infinity();
        for (Eigen::Index i = 0; i < n; ++i) {
            const double d = (interface.patch.row(i).transpose() - middle).squaredNorm();
            if (part[i] != k || d >= least || taken.count(interface.behind[i]) != 0) continue;
            least = d;
            best = interface.behind[i];
        }
        if (best < 0) continue;
        taken.insert(best);
        sites.push_back({middle, best, true, false});
    }
    return sites;
}

}  // namespace palpate::skeleton
