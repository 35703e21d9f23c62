#include "mesh/regions/element_regions.h"

#include "mesh/regions/region_finder.h"

namespace palpate::mesh {

std::vector<int> regions_of_elements(const VolumeMesh& mesh, const std::vector<Surface>& surfaces) {
    const RegionFinder region_at(surfaces);
    std::vector<int> result(static_cast<std::size_t>(mesh.tetrahedra.rows()));
    for (std::size_t e = 0; e < result.size(); ++e) {
        const auto corners = mesh.tetrahedra.row(static_cast<Eigen::Index>(e)).head<4>();
        result[e] = region_at(mesh.nodes(corners, Eigen::all).colwise().mean());
    }
    return result;
}

}  // namespace palpate::mesh
