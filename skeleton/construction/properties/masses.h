#pragma once

#include <vector>

#include "skeleton/construction/shape/tet_graph.h"
#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// Gives each sphere the volume and mass of its cell, and that mass' inertia about the sphere's centre; the masses add
/// up to the body's. `density` [tonne/mm^3].
void set_masses(const TetGraph& graph, const std::vector<int>& owner, double density, std::vector<Sphere>& spheres);

}  // namespace palpate::skeleton
