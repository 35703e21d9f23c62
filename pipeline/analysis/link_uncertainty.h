#pragma once

#include <vector>

#include "identify/inference/posterior_row.h"
#include "mesh/formats/vtk/vtk_files.h"

namespace palpate::pipeline {

/// How uncertain each link's stiffness is: an array "<kind> sd/mean [-]" for each kind that was identified (links). NaN
/// for links that no row of the posterior stands for. `zones`: of the links (l).
std::vector<mesh::DataArray> link_uncertainty(const std::vector<identify::PosteriorRow>& posterior,
                                              const Eigen::VectorXd& zones);

}  // namespace palpate::pipeline
