#pragma once

#include <Eigen/Core>
#include <vector>

#include "fem/hyperelastic_body.h"
#include "identify/models/body_statics.h"
#include "mesh/core/material_region.h"

namespace palpate::identify {

/// Places in theta of a ReferenceBody: ln E, ln(1 - 2 nu), then ln E of each region.
constexpr int ln_young = 0, ln_compressibility = 1, first_region = 2;

/// A fit may try numbers where no material is. @throws SolverFailure where it does.
void require_material(const fem::Material& material);

/// What the body is made of at a setting.
fem::Material body_material(const ModelSetting& setting, double density);
/// What a region of it is made of.
fem::Material region_material(const mesh::MaterialRegion& region, double log_young, const fem::Material& body);

/// How the internal forces of a material grow with ln E and with ln(1 - 2 nu); `unit`: those at unit moduli (3n x 2).
Eigen::Matrix<double, Eigen::Dynamic, 2> slopes_of(const fem::Material& material, const Eigen::MatrixXd& unit);

/// The elements of each region, with its density over that of the body [tonne/mm^3].
/// @throws InvalidInput where a region has next to none.
fem::ElementRegions element_regions(const mesh::VolumeMesh& mesh, const std::vector<mesh::MaterialRegion>& regions,
                                    double density);

}  // namespace palpate::identify
