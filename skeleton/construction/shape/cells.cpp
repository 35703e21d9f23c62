#include "skeleton/construction/shape/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>

#include "mesh/errors.h"
#include "mesh/numbers/median.h"

namespace palpate::skeleton {
namespace {

// Sites have settled where none moves by more than this of the spacing; slow ones are left as they are after so many
// rounds. Choices: where they stand exactly is of no concern.
constexpr double settled = 0.02;
constexpr int most_rounds = 40;
// Of the volume that a site is to have: one with less is idle where the largest cell has so many times as much, half of
// which then is more for both.
constexpr double idle = 0.35, much_larger = 3;

double distance(const TetGraph& graph, const Core& core, int tet, const Site& site) {
    return ((site.extra ? graph.centers : core.at).row(tet).transpose() - site.at).norm();
}

// Distances of all tetrahedra from a new site, through neighbours that it is nearest to.
void lower_distances(const TetGraph& graph, const Core& core, const Site& site, Eigen::VectorXd& distances) {
    std::vector<int> front{site.tet};
    distances(site.tet) = std::min(distances(site.tet), distance(graph, core, site.tet, site));
    for (std::size_t i = 0; i < front.size(); ++i) {
        for (int c = 0; c < 4; ++c) {
            const int u = graph.neighbors(front[i], c);
            if (u < 0) continue;
            const double d = distance(graph, core, u, site);
            if (d >= distances(u)) continue;
            distances(u) = d;
            front.push_back(u);
        }
    }
}

// A cell grows on from its tetrahedron that is nearest to the site.
void find_starts(const TetGraph& graph, const Core& core, const std::vector<int>& owner, std::vector<Site>& sites) {
    std::vector<double> nearest(sites.size(), std::numeric_limits<double>::infinity());
    for (int t = 0; t < graph.size(); ++t) {
        Site& site = sites[owner[t]];
        const double d = distance(graph, core, t, site);
        if (site.held || site.extra || d >= nearest[owner[t]]) continue;
        nearest[owner[t]] = d;
        site.tet = t;
    }
}

// After sites moved a little: tetrahedra go over to neighbours' sites that are nearer, until none will.
void regrow_cells(const TetGraph& graph, const Core& core, const std::vector<char>& held,
                  const std::vector<Site>& sites, std::vector<int>& owner) {
    Eigen::VectorXd distances(graph.size());
    for (int t = 0; t < graph.size(); ++t) distances(t) = distance(graph, core, t, sites[owner[t]]);
    std::vector<int> front(graph.size());
    std::iota(front.begin(), front.end(), 0);
    for (std::size_t i = 0; i < front.size(); ++i) {
        const int t = front[i];
        for (int c = 0; c < 4; ++c) {
            const int u = graph.neighbors(t, c);
            if (u < 0 || owner[u] == owner[t] || held[u] != held[t]) continue;
            const double d = distance(graph, core, u, sites[owner[t]]);
            if (d >= distances(u)) continue;
            distances(u) = d;
            owner[u] = owner[t];
            front.push_back(u);
        }
    }
}

void settle(const TetGraph& graph, const Core& core, const std::vector<char>& held, double spacing,
            std::vector<Site>& sites) {
    double step = spacing;
    std::vector<int> owner = grow_cells(graph, core, held, sites);
    for (int round = 0; round < most_rounds && step > settled * spacing; ++round) {
        if (round > 0) regrow_cells(graph, core, held, sites, owner);
        Points middle = Points::Zero(std::ssize(sites), 3);
        Eigen::VectorXd volume = Eigen::VectorXd::Zero(std::ssize(sites));
        for (int t = 0; t < graph.size(); ++t) {
            middle.row(owner[t]) += graph.volumes(t) * core.at.row(t);
            volume(owner[t]) += graph.volumes(t);
        }
        step = 0;
        for (std::size_t s = 0; s < sites.size(); ++s) {
            if (sites[s].held || sites[s].extra) continue;
            const auto row = static_cast<Eigen::Index>(s);
            const Vec3 target = middle.row(row) / volume(row);
            step = std::max(step, (target - sites[s].at).norm());
            sites[s].at = target;
        }
        find_starts(graph, core, owner, sites);
    }
}

// The tetrahedron of a cell that half of it is nearer to the site than.
int halfway(const TetGraph& graph, const Core& core, const std::vector<int>& owner, int cell, const Site& site) {
    std::vector<std::pair<double, int>> order;
    for (int t = 0; t < graph.size(); ++t) {
        if (owner[t] == cell && t != site.tet) order.emplace_back(distance(graph, core, t, site), t);
    }
    if (order.empty()) return site.tet;
    return mesh::upper_median(std::move(order)).second;
}

// Sites that got stuck in a corner of the core go to help with the largest cell. Were there any?
bool move_idle(const TetGraph& graph, const Core& core, const std::vector<char>& held, const Eigen::VectorXd& shares,
               std::vector<Site>& sites) {
    const std::vector<int> owner = grow_cells(graph, core, held, sites);
    std::vector<double> share(sites.size(), 0.);
    for (int t = 0; t < graph.size(); ++t) {
        if (!sites[owner[t]].held) share[owner[t]] += shares(t);
    }
    bool moved = false;
    for (std::size_t s = 0; s < sites.size(); ++s) {
        if (sites[s].held || sites[s].extra || share[s] > idle) continue;
        const auto largest = std::max_element(share.begin(), share.end()) - share.begin();
        if (share[largest] < much_larger * share[s]) continue;
        const int tet = halfway(graph, core, owner, static_cast<int>(largest), sites[largest]);
        if (tet == sites[largest].tet) continue;
        sites[s].at = core.at.row(tet);
        sites[s].tet = tet;
        share[largest] /= 2;
        share[s] = share[largest];
        moved = true;
    }
    return moved;
}

}  // namespace

std::vector<int> grow_cells(const TetGraph& graph, const Core& core, const std::vector<char>& held,
                            const std::vector<Site>& sites) {
    using Claim = std::tuple<double, int, int>;  // distance, tetrahedron, site
    std::priority_queue<Claim, std::vector<Claim>, std::greater<>> claims;
    std::vector<int> owner(graph.size(), -1);
    const auto take = [&](int tet, int site, bool all) {
        owner[tet] = site;
        for (int c = 0; c < 4; ++c) {
            const int u = graph.neighbors(tet, c);
            if (u < 0 || owner[u] >= 0 || (!all && held[u] && !sites[site].held)) continue;
            claims.emplace(distance(graph, core, u, sites[site]), u, site);
        }
    };
    const auto grow = [&](bool all) {
        while (!claims.empty()) {
            const auto [d, tet, site] = claims.top();
            claims.pop();
            if (owner[tet] < 0) take(tet, site, all);
        }
    };
    for (std::size_t s = 0; s < sites.size(); ++s) owner[sites[s].tet] = static_cast<int>(s);
    for (std::size_t s = 0; s < sites.size(); ++s) take(sites[s].tet, static_cast<int>(s), false);
    grow(false);
    // Held material that no held site reaches goes to whoever is next to it.
    for (int t = 0; t < graph.size(); ++t) {
        if (owner[t] >= 0) take(t, owner[t], true);
    }
    grow(true);
    return owner;
}

void add_sites(const TetGraph& graph, const Core& core, const std::vector<char>& held, int count,
               std::vector<Site>& sites) {
    std::vector<char> taken(held);
    Eigen::VectorXd distances = Eigen::VectorXd::Constant(graph.size(), std::numeric_limits<double>::infinity());
    for (const Site& site : sites) {
        lower_distances(graph, core, site, distances);
        taken[site.tet] = 1;
    }
    for (int n = 0; n < count; ++n) {
        int furthest = -1;
        for (int t = 0; t < graph.size(); ++t) {
            // Equal distances, but for rounding, fall to the first: the choice is the same on all machines.
            if (!taken[t] && (furthest < 0 || distances(t) > distances(furthest) * (1 + 1e-9))) furthest = t;
        }
        if (furthest < 0 || !(distances(furthest) > 0)) {
            throw InvalidInput(fmt::format(
                "{} spheres were asked for, but there is room for {} in the body outside its supports: ask for fewer",
                count, n));
        }
        sites.push_back({core.at.row(furthest), furthest});
        taken[furthest] = 1;
        lower_distances(graph, core, sites.back(), distances);
    }
}

void relax_sites(const TetGraph& graph, const Core& core, const std::vector<char>& held, double spacing,
                 const Eigen::VectorXd& shares, std::vector<Site>& sites) {
    for (int round = 0; round < 8; ++round) {
        settle(graph, core, held, spacing, sites);
        if (!move_idle(graph, core, held, shares, sites)) return;
    }
    settle(graph, core, held, spacing, sites);
}

}  // namespace palpate::skeleton
