#pragma once

#include <vector>

#include "mesh/core/region.h"
#include "skeleton/construction/shape/cells.h"

namespace palpate::skeleton {

/// The supported part of a body, and its interface to the free material.
struct SupportInterface {
    std::vector<char> held;       // of each tetrahedron: all of it is held, or it stands on a plate's held face (m)
    std::vector<char> held_node;  // (n)
    Points patch;  // middles of the faces between held and free, of held outer faces, or held nodes (k x 3) [mm]
    std::vector<int> behind;  // the tetrahedron that each belongs to (k)
    Eigen::VectorXd weight;   // their areas (k) [mm^2]
};

/// @throws InvalidInput when the supports hold nothing, or all.
SupportInterface find_support_interface(const TetGraph& graph, const std::vector<mesh::Region>& supports);

/// A support may hold a plate by its face, and no depth of it. What stands on such a face counts as held then, or cells
/// that reach through the plate would take the face, and nothing would tie their spheres to it.
void hold_faces_of_plates(const TetGraph& graph, const Core& core, SupportInterface& interface);

/// Held sites on the patch, `spacing` [mm] apart: one for a limb's end, a row or a layer on wider ones.
std::vector<Site> interface_sites(const Core& core, const SupportInterface& interface, double spacing);

}  // namespace palpate::skeleton
