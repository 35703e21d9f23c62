#include "identify/models/reference/reference_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/errors.h"
#include "mesh/regions/element_regions.h"

namespace palpate::identify {

void require_material(const fem::Material& material) {
    // A choice within (-1, 1/2), where isotropic materials are stable: at either end a modulus is infinite.
    constexpr double least = -0.9, most = 0.49999;
    if (material.poisson > least && material.poisson < most && std::isfinite(material.young)) return;
    throw SolverFailure(
        fmt::format("the fit asks for a Poisson's ratio of {:.3g} and a Young's modulus of {:.3g} MPa; "
                    "allowed are ratios from {} to {}",
                    material.poisson, material.young, least, most));
}

fem::Material body_material(const ModelSetting& setting, double density) {
    // theta = (ln E, ln(1 - 2 nu))
    return {.young = std::exp(setting.theta[ln_young]),
            .poisson = 0.5 * (1 - std::exp(setting.theta[ln_compressibility])),
            .density = density};
}

fem::Material region_material(const mesh::MaterialRegion& region, double log_young, const fem::Material& body) {
    fem::Material material = body;
    material.young = std::exp(log_young);
    if (region.poisson) material.poisson = *region.poisson;
    if (region.density) material.density = *region.density;
    return material;
}

// f = mu a + K b with mu = E / (2 (1 + nu)), K = E / (3 (1 - 2 nu)); t = ln(1 - 2 nu): d nu/dt = -(1 - 2 nu)/2,
// so d mu/dt = mu (1 - 2 nu) / (2 (1 + nu)) and dK/dt = -K.
Eigen::Matrix<double, Eigen::Dynamic, 2> slopes_of(const fem::Material& m, const Eigen::MatrixXd& unit) {
    const double mu = m.shear_modulus(), K = m.bulk_modulus();
    Eigen::Matrix<double, Eigen::Dynamic, 2> slopes(unit.rows(), 2);
    slopes.col(0) = mu * unit.col(0) + K * unit.col(1);
    slopes.col(1) = mu * (1 - 2 * m.poisson) / (2 * (1 + m.poisson)) * unit.col(0) - K * unit.col(1);
    return slopes;
}

fem::ElementRegions element_regions(const mesh::VolumeMesh& mesh, const std::vector<mesh::MaterialRegion>& regions,
                                    double density) {
    constexpr int least = 4;  // fewer do not show how a part bends
    fem::ElementRegions result;
    if (regions.empty()) return result;
    std::vector<mesh::Surface> surfaces;
    surfaces.reserve(regions.size());
    for (const mesh::MaterialRegion& region : regions) surfaces.push_back(region.surface);
    result.of_element = mesh::regions_of_elements(mesh, surfaces);
    for (std::size_t r = 0; r < surfaces.size(); ++r) {
        const mesh::MaterialRegion& region = regions[r];
        result.density.push_back(region.density && density > 0 ? *region.density / density : 1);
        const auto own = std::ranges::count(result.of_element, static_cast<int>(r));
        if (own < least)
            throw InvalidInput(fmt::format(
                "region '{}' has {} of the mesh's elements; at least {} are needed. Take the region out, or "
                "give a mesh that is finer there, or the surface alone, which is meshed along the region.",
                region.name, own, least));
    }
    return result;
}

}  // namespace palpate::identify
