#pragma once

#include <vector>

#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

/// For each element the region that its centre lies in, by place among `surfaces`; where these are nested, the
/// innermost one; -1: none (m). @pre the surfaces are closed, and disjoint or nested.
std::vector<int> regions_of_elements(const VolumeMesh& mesh, const std::vector<Surface>& surfaces);

}  // namespace palpate::mesh
