#include "pipeline/output/vtk/stiffness_map_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "identify/effects/body/material/stiffness_parts.h"
#include "mesh/formats/volume/labelled_parts.h"
#include "mesh/formats/vtk/vtk_files.h"

namespace palpate::pipeline {
namespace {

/// The set with parts of the body as regions. @param part_of each element, from 1 on; 0: none
identify::MeasurementSet with_regions(identify::MeasurementSet set, const mesh::VolumeMesh& body,
                                      const std::vector<std::int64_t>& part_of, const std::filesystem::path& file) {
    set.rest_volume = body;
    set.rest_surface = mesh::boundary_surface(body);
    std::vector<int> parts;
    for (const auto part : std::set(part_of.begin(), part_of.end()))
        if (part > 0) parts.push_back(static_cast<int>(part));
    const std::vector<mesh::Surface> surfaces = mesh::labelled_parts(body, part_of, parts, file);
    for (std::size_t p = 0; p < parts.size(); ++p)
        set.regions.push_back({.name = fmt::format("part-{}", parts[p]), .surface = surfaces[p]});
    return set;
}

}  // namespace

bool write_stiffness_map(const std::filesystem::path& folder, const mesh::VolumeMesh& body,
                         const identify::MeasurementSet& set, const identify::Diagnosis& diagnosis) {
    const std::filesystem::path file = folder / "map.vtu", regions = folder / map_regions;
    std::filesystem::remove(file);
    std::filesystem::remove_all(regions);
    if (!diagnosis.explained || !diagnosis.explained->has("map")) return false;
    const identify::EffectEstimate estimate = diagnosis.explained->estimate("map");
    const identify::StiffnessEstimate map(estimate.effect, estimate.covariance);
    Eigen::MatrixXd stiffness(body.tetrahedra.rows(), 1), sd(body.tetrahedra.rows(), 1),
        shown(body.tetrahedra.rows(), 1);
    std::vector<std::int64_t> part_of;
    for (const int part : map.part_of_elements(body)) part_of.push_back(part + 1);
    for (Eigen::Index e = 0; e < body.tetrahedra.rows(); ++e) {
        Vec3 centre = Vec3::Zero();
        for (int corner = 0; corner < 4; ++corner) centre += body.nodes.row(body.tetrahedra(e, corner)).transpose() / 4;
        stiffness(e, 0) = std::exp(map.log_stiffness(centre));
        sd(e, 0) = map.sd(centre);
        shown(e, 0) = static_cast<double>(part_of[static_cast<std::size_t>(e)]);
    }
    mesh::write_vtu(file, body,
                    {.points = {},
                     .cells = {{"stiffness over its mean [-]", stiffness},
                               {"standard deviation of ln stiffness [-]", sd},
                               {"part", shown}}});
    const bool stands_out = std::ranges::any_of(part_of, [](auto part) { return part > 0; });
    if (!stands_out || !set.regions.empty()) return false;
    identify::write_measurement_set(regions, with_regions(set, body, part_of, file), {});
    return true;
}

}  // namespace palpate::pipeline
