#include "pipeline/output/vtk/stiffness_map_file.h"

#include <cmath>

#include "identify/effects/body/material/stiffness_parts.h"
#include "mesh/formats/vtk/vtk_files.h"

namespace palpate::pipeline {

void write_stiffness_map(const std::filesystem::path& folder, const mesh::VolumeMesh& body,
                         const identify::Diagnosis& diagnosis) {
    std::filesystem::remove(folder / "map.vtu");
    if (!diagnosis.explained || !diagnosis.explained->has("map")) return;
    const identify::EffectEstimate estimate = diagnosis.explained->estimate("map");
    const identify::StiffnessEstimate map(estimate.effect, estimate.covariance);
    Eigen::MatrixXd stiffness(body.tetrahedra.rows(), 1), sd(body.tetrahedra.rows(), 1);
    for (Eigen::Index e = 0; e < body.tetrahedra.rows(); ++e) {
        Vec3 centre = Vec3::Zero();
        for (int corner = 0; corner < 4; ++corner) centre += body.nodes.row(body.tetrahedra(e, corner)).transpose() / 4;
        stiffness(e, 0) = std::exp(map.log_stiffness(centre));
        sd(e, 0) = map.sd(centre);
    }
    mesh::write_vtu(
        folder / "map.vtu", body,
        {.points = {},
         .cells = {{"stiffness over its mean [-]", stiffness}, {"standard deviation of ln stiffness [-]", sd}}});
}

}  // namespace palpate::pipeline
