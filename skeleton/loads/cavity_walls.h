#pragma once

#include <array>
#include <vector>

#include "mesh/core/actuator.h"
#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// The wall of a cavity: triangles of the skin by their corners, counter-clockwise seen from the body.
using CavityWall = std::vector<std::array<int, 3>>;

/// The walls of each of a skin's cavities, as Cavities describes them.
std::vector<CavityWall> walls_by_cavity(const Model& model);

/// Which of a model's cavities an actuator means: that with a wall nearest to the point, or nearest in the mean to the
/// vertices of the surface; -1 where there are none.
int find_cavity(const Model& model, const std::vector<CavityWall>& cavities, const mesh::PressureActuator& actuator);

}  // namespace palpate::skeleton
