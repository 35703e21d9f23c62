#pragma once

#include <string>
#include <vector>

#include "pipeline/analysis/density.h"

namespace palpate::pipeline {

/// Section of the report page: what is known of the stiffnesses before and after measuring. Densities of each kind, all
/// links' together; of any one number among those that the data determine best; and their intervals.
/// @param particles of the same identification; may be none: then there are no densities
/// @param file      where all numbers stand, within the run
std::string stiffness_section(const std::vector<identify::PosteriorRow>& posterior, const ParticleSet& particles,
                              PriorKind prior, const std::string& file);

}  // namespace palpate::pipeline
