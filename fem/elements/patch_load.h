#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "mesh/core/contact.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// Consistent nodal forces of contacts (3n x number of contacts) [N].
///
/// Each contact's force is spread evenly over the surface within `radius` of its point: the faces there are sampled
/// finely, so that the patch is a disc and not the set of faces whose centre happens to lie inside. Radius 0: the
/// nearest surface point. The nodal forces of a contact add up to its force.
/// @throws InvalidInput, naming the contact's place, when it lies further from the surface than its radius plus
/// `reach` [mm].
Eigen::SparseMatrix<double> patch_loads(const mesh::VolumeMesh& mesh, const std::vector<mesh::Contact>& contacts,
                                        double reach);

}  // namespace palpate::fem
