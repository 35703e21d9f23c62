#pragma once

#include <vector>

#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// Do the held nodes (a flag per node) stop every rigid motion of every part of the body?
/// @throws InvalidInput, saying where and what to do, when nothing or everything is held, a part of the body has fewer
/// than three held nodes or all of them on one line, or a node belongs to no element.
void check_restraint(const mesh::VolumeMesh& mesh, const std::vector<char>& held);

}  // namespace palpate::fem
