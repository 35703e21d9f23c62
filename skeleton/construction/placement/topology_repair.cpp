#include "skeleton/construction/placement/topology_repair.h"

#include <algorithm>
#include <limits>
#include <map>

#include "skeleton/construction/properties/sections.h"

namespace palpate::skeleton {
namespace {

using Bits = std::uint64_t;

// What a way within its cell goes round from the cell's site to each tetrahedron (m), and for cells that close on
// themselves the place opposite to the site.
struct CellPaths {
    std::vector<Bits> round;
    std::map<int, int> closing;  // cell, tetrahedron

    CellPaths(const PlacementBody& body, const Handles& handles, const std::vector<int>& owner,
              const std::vector<Site>& sites)
        : round(body.graph.size()) {
        std::vector<char> seen(body.graph.size());
        std::vector<int> front;
        for (const Site& site : sites) {
            seen[site.tet] = 1;
            front.push_back(site.tet);
        }
        for (std::size_t i = 0; i < front.size(); ++i) {
            const int t = front[i];
            for (int c = 0; c < 4; ++c) {
                const int u = body.graph.neighbors(t, c);
                if (u < 0 || owner[u] != owner[t]) continue;
                const Bits bits = round[t] ^ handles.crossing[t][c];
                if (!seen[u]) {
                    seen[u] = 1;
                    round[u] = bits;
                    front.push_back(u);
                } else if (round[u] != bits) {
                    closing.try_emplace(owner[t], t);
                }
            }
        }
    }
};

// The faces where two cells meet on one side of the handles.
struct Border {
    double area = 0;
    Vec3 first = Vec3::Zero();  // area times position
    std::vector<int> tets;      // on both sides of them
};

using Pair = std::pair<int, int>;                         // cells a < b
using Meetings = std::map<Pair, std::map<Bits, Border>>;  // what a way from a to b through the border goes round
using Neighbors = std::map<int, std::vector<std::pair<int, Bits>>>;

Meetings find_meetings(const PlacementBody& body, const Handles& handles, const std::vector<int>& owner,
                       const std::vector<Site>& sites, const CellPaths& paths) {
    const TetGraph& graph = body.graph;
    Meetings meetings;
    for (int t = 0; t < graph.size(); ++t) {
        for (int c = 0; c < 4; ++c) {
            const int u = graph.neighbors(t, c);
            if (u < 0 || owner[u] <= owner[t] || (sites[owner[t]].held && sites[owner[u]].held)) continue;
            const Bits bits = paths.round[t] ^ handles.crossing[t][c] ^ paths.round[u];
            Border& border = meetings[{owner[t], owner[u]}][bits];
            const double area = graph.face_area(t, c).norm();
            border.area += area;
            border.first += area * (graph.centers.row(t) + graph.centers.row(u)).transpose() / 2;
            border.tets.insert(border.tets.end(), {t, u});
        }
    }
    return meetings;
}

// Chords of a bent body lie outside by a little.
bool leaves_body(const mesh::SurfaceTree& tree, const Vec3& a, const Vec3& b, double tolerance) {
    constexpr int samples = 12;
    const double allowed = std::max(tolerance, 0.1 * (b - a).norm());
    for (int i = 1; i < samples; ++i) {
        const Vec3 x = a + i * (b - a) / samples;
        if (!tree.inside(x) && tree.closest(x).distance > allowed) return true;
    }
    return false;
}

// Does a third cell link the two, on the side of the handles that `bits` tell?
bool detour(const Neighbors& neighbors, const Pair& pair, Bits bits) {
    const auto from_a = neighbors.find(pair.first), from_b = neighbors.find(pair.second);
    if (from_a == neighbors.end() || from_b == neighbors.end()) return false;
    for (const auto& [c, to_c] : from_a->second) {
        for (const auto& [d, from_d] : from_b->second) {
            if (c == d && (to_c ^ from_d) == bits) return true;
        }
    }
    return false;
}

}  // namespace

TopologyRepair find_topology_repair(const PlacementBody& body, const mesh::SurfaceTree& tree, const Handles& handles,
                                    const std::vector<int>& owner, const std::vector<Site>& sites, double tolerance) {
    const TetGraph& graph = body.graph;
    std::set<int> taken;
    for (const Site& site : sites) taken.insert(site.tet);
    TopologyRepair repair;
    // New sites keep `apart` from the others.
    const auto add = [&](int tet, double apart) {
        if (body.interface.held[tet] || taken.count(tet) != 0) return;
        const Vec3 center = graph.centers.row(tet), on_core = body.core.at.row(tet);
        const Site site{tree.inside(on_core) ? on_core : center, tet};
        const auto close = [&](const Site& other) { return (other.at - site.at).norm() < apart; };
        if (std::any_of(sites.begin(), sites.end(), close)) return;
        if (std::any_of(repair.required_sites.begin(), repair.required_sites.end(), close)) return;
        taken.insert(tet);
        repair.required_sites.push_back(site);
    };
    // In the middle of a border.
    const auto add_on = [&](const Border& border, double apart) {
        const Vec3 middle = border.first / border.area;
        int best = -1;
        double least = std::numeric_limits<double>::infinity();
        for (int t : border.tets) {
            const double d = (graph.centers.row(t).transpose() - middle).squaredNorm();
            if (d >= least || body.interface.held[t] || taken.count(t) != 0) continue;
            least = d;
            best = t;
        }
        if (best >= 0) add(best, apart);
    };

    const CellPaths paths(body, handles, owner, sites);
    for (const auto& [cell, tet] : paths.closing) add(tet, tolerance);
    const Meetings meetings = find_meetings(body, handles, owner, sites, paths);
    double mean = 0;
    for (const auto& [pair, borders] : meetings) {
        for (const auto& [bits, border] : borders) mean += border.area / static_cast<double>(meetings.size());
    }

    Neighbors neighbors;  // by links that lie inside
    std::vector<Pair> outside;
    for (const auto& [pair, borders] : meetings) {
        if (paths.closing.count(pair.first) != 0 || paths.closing.count(pair.second) != 0) continue;
        const auto& [a, b] = pair;
        const auto smaller = [](const auto& p, const auto& q) { return p.second.area < q.second.area; };
        if (borders.size() > 1) {
            add_on(std::min_element(borders.begin(), borders.end(), smaller)->second, tolerance);
        } else if (leaves_body(tree, sites[a].at, sites[b].at, tolerance)) {
            outside.push_back(pair);
        } else if (borders.begin()->second.area >= sliver * mean) {
            neighbors[a].emplace_back(b, borders.begin()->first);
            neighbors[b].emplace_back(a, borders.begin()->first);
        }
    }
    for (const Pair& pair : outside) {
        const auto& [bits, border] = *meetings.at(pair).begin();
        if (detour(neighbors, pair, bits)) {
            repair.redundant.insert(pair);
        } else if (border.area >= sliver * mean) {
            add_on(border, 0.3 * (sites[pair.first].at - sites[pair.second].at).norm());
        }
    }
    return repair;
}

}  // namespace palpate::skeleton
