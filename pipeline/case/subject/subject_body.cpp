#include "pipeline/case/subject/subject_body.h"

#include <algorithm>
#include <string>
#include <utility>

#include "mesh/regions/element_regions.h"

namespace palpate::pipeline {
namespace {

const std::string region_array = "region";

}  // namespace

MeshedBody make_body(const Subject& subject, MeshingOptions options, const Progress& progress) {
    options.regions = subject.regions;
    options.held.insert(options.held.end(), subject.supports.begin(), subject.supports.end());
    if (!subject.volume) return make_body(subject.surface, options, progress);
    return ready_made_body(*subject.volume, subject.surface, options);
}

std::vector<int> element_regions(const Subject& subject, const MeshedBody& body) {
    if (subject.regions.empty()) return {};
    return mesh::regions_of_elements(body.volume, body.interfaces);
}

fem::Materials materials_of(const Subject& subject, std::vector<int> element_regions) {
    const fem::Material& body = subject.material;
    fem::Materials materials{.body = body};
    for (const mesh::MaterialRegion& region : subject.regions)
        materials.regions.push_back({.young = region.young.value_or(body.young),
                                     .poisson = region.poisson.value_or(body.poisson),
                                     .density = region.density.value_or(body.density)});
    materials.of_element = std::move(element_regions);
    return materials;
}

mesh::MeshData regions_shown(const std::vector<int>& element_regions) {
    if (element_regions.empty()) return {};
    Eigen::MatrixXd shown(std::ssize(element_regions), 1);
    for (Eigen::Index e = 0; e < shown.rows(); ++e) shown(e) = element_regions[static_cast<std::size_t>(e)] + 1;
    return {.points = {}, .cells = {{region_array, std::move(shown)}}};
}

std::vector<int> regions_read(const mesh::MeshData& data) {
    const auto found = std::ranges::find(data.cells, region_array, &mesh::DataArray::name);
    if (found == data.cells.end()) return {};
    std::vector<int> regions(static_cast<std::size_t>(found->values.rows()));
    for (std::size_t e = 0; e < regions.size(); ++e)
        regions[e] = static_cast<int>(found->values(static_cast<Eigen::Index>(e))) - 1;
    return regions;
}

}  // namespace palpate::pipeline
