#pragma once

#include <vector>

#include "skeleton/model.h"
#include "skeleton/placement/tet_graph.h"

namespace palpate::skeleton {

/// Gives each sphere the volume and mass of its cell, and that mass' inertia about the sphere's centre; the masses add
/// up to the body's. `density` [tonne/mm^3].
void set_masses(const TetGraph& graph, const std::vector<int>& owner, double density, std::vector<Sphere>& spheres);

}  // namespace palpate::skeleton
