#include "skeleton/construction/placement/place.h"

#include <algorithm>

#include "skeleton/construction/placement/topology_repair.h"

namespace palpate::skeleton {
namespace {

// Lloyd's middles may lie outside a bent body or in a support: the nearest place of the cell is taken then.
void keep_inside(const PlacementBody& body, const mesh::SurfaceTree& tree, const std::vector<mesh::Region>& supports,
                 std::vector<Site>& sites) {
    for (Site& site : sites) {
        if (site.held || (tree.inside(site.at) && !mesh::contains(supports, site.at))) continue;
        site.at = body.graph.centers.row(site.tet);
    }
}

std::vector<Site> spread_evenly(const PlacementBody& body, const mesh::SurfaceTree& tree,
                                const std::vector<mesh::Region>& supports, double spacing, int spheres) {
    std::vector<Site> sites = interface_sites(body.core, body.interface, spacing);
    add_sites(body.graph, body.core, body.interface.held, spheres, sites);
    relax_sites(body.graph, body.core, body.interface.held, spacing,
                sphere_shares(body.free_volumes, body.core, spacing), sites);
    keep_inside(body, tree, supports, sites);
    return sites;
}

}  // namespace

std::ptrdiff_t free_sites(const std::vector<Site>& sites) {
    return std::count_if(sites.begin(), sites.end(), [](const Site& site) { return !site.held; });
}

void repair_topology(const PlacementBody& body, const mesh::SurfaceTree& tree, const Handles& handles, double tolerance,
                     std::ptrdiff_t most, std::vector<Site>& sites) {
    for (int round = 0; round < 8 && free_sites(sites) < most; ++round) {
        const std::vector<int> owner = grow_cells(body.graph, body.core, body.interface.held, sites);
        std::vector<Site> added = find_topology_repair(body, tree, handles, owner, sites, tolerance).required_sites;
        if (added.empty()) return;
        const std::ptrdiff_t room = most - free_sites(sites);
        added.resize(std::min(added.size(), static_cast<std::size_t>(room)));
        sites.insert(sites.end(), added.begin(), added.end());
    }
}

std::vector<Site> place_sites(const PlacementBody& body, const mesh::SurfaceTree& tree, const Handles& handles,
                              const std::vector<mesh::Region>& supports, double spacing, double tolerance, int spheres,
                              bool exactly) {
    std::vector<Site> sites = spread_evenly(body, tree, supports, spacing, spheres);
    repair_topology(body, tree, handles, tolerance, spheres + spheres / 2 + 4, sites);
    const int over = static_cast<int>(free_sites(sites)) - spheres;
    if (!exactly || over == 0) return sites;

    // As many as mending takes are left out first; what it does not take then goes where there is most room.
    sites = spread_evenly(body, tree, supports, spacing, std::max((spheres + 1) / 2, spheres - over));
    repair_topology(body, tree, handles, tolerance, spheres, sites);
    add_sites(body.graph, body.core, body.interface.held, spheres - static_cast<int>(free_sites(sites)), sites);
    return sites;
}

}  // namespace palpate::skeleton
