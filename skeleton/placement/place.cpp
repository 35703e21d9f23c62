#include "skeleton/placement/place.h"

#include <algorithm>

#include "skeleton/placement/mend.h"

namespace palpate::skeleton {
namespace {

// Lloyd's middles may lie outside a bent body or in a support: the nearest place of the cell is taken then.
void keep_inside(const Body& body, const mesh::SurfaceTree& tree, const std::vector<mesh::Region>& supports,
                 std::vector<Site>& sites) {
    for (Site& site : sites) {
        if (site.held || (tree.inside(site.at) && !mesh::contains(supports, site.at))) continue;
        site.at = body.graph.centers.row(site.tet);
    }
}

std::vector<Site> spread_evenly(const Body& body, const mesh::SurfaceTree& tree,
                                const std::vector<mesh::Region>& supports, double spacing, int spheres) {
    std::vector<Site> sites = ground_sites(body.core, body.ground, spacing);
    add_sites(body.graph, body.core, body.ground.held, spheres, sites);
    relax_sites(body.graph, body.core, body.ground.held, spacing, sphere_shares(body.free_volumes, body.core, spacing),
                sites);
    keep_inside(body, tree, supports, sites);
    return sites;
}

}  // namespace

std::ptrdiff_t free_sites(const std::vector<Site>& sites) {
    return std::count_if(sites.begin(), sites.end(), [](const Site& site) { return !site.held; });
}

void mend_sites(const Body& body, const mesh::SurfaceTree& tree, const Handles& handles, double tolerance,
                std::ptrdiff_t most, std::vector<Site>& sites) {
    for (int round = 0; round < 8 && free_sites(sites) < most; ++round) {
        const std::vector<int> owner = grow_cells(body.graph, body.core, body.ground.held, sites);
        std::vector<Site> added = find_mending(body, tree, handles, owner, sites, tolerance).wanted;
        if (added.empty()) return;
        const std::ptrdiff_t room = most - free_sites(sites);
        added.resize(std::min(added.size(), static_cast<std::size_t>(room)));
        sites.insert(sites.end(), added.begin(), added.end());
    }
}

std::vector<Site> place_sites(const Body& body, const mesh::SurfaceTree& tree, const Handles& handles,
                              const std::vector<mesh::Region>& supports, double spacing, double tolerance, int spheres,
                              bool exactly) {
    std::vector<Site> sites = spread_evenly(body, tree, supports, spacing, spheres);
    mend_sites(body, tree, handles, tolerance, spheres + spheres / 2 + 4, sites);
    const int over = static_cast<int>(free_sites(sites)) - spheres;
    if (!exactly || over == 0) return sites;

    // As many as mending takes are left out first; what it does not take then goes where there is most room.
    sites = spread_evenly(body, tree, supports, spacing, std::max((spheres + 1) / 2, spheres - over));
    mend_sites(body, tree, handles, tolerance, spheres, sites);
    add_sites(body.graph, body.core, body.ground.held, spheres - static_cast<int>(free_sites(sites)), sites);
    return sites;
}

}  // namespace palpate::skeleton
