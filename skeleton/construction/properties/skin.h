#pragma once

#include <vector>

#include "fem/material.h"
#include "skeleton/construction/shape/tet_graph.h"
#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// How the surface of a body follows its spheres, from the body in finite elements: static condensation on the mean
/// motions of the spheres' cells [Guyan 1965], kept to a few spheres a vertex.
///
/// With C the body's compliance and E the mean motion of each free sphere's cell, unit forces on the spheres move the
/// spheres by Q = E C E^T and the surface by Y = C E^T. Each vertex takes a smooth mean of the spheres nearby (Gaussian
/// weights, reached through the links, so that no vertex is attached to another limb) and, by ridge regression of Y on
/// Q, what it moves beyond that when they move against one another. So rigid motions are followed exactly, a Poisson's
/// ratio bulges the skin, and by virtual work forces on the skin reach the spheres as they do in the body.
///
/// `owner`: the sphere of each of the graph's tetrahedra, as assign_cells has it; the graph's tetrahedra are equal
/// parts of the body's, in their order. The model has its spheres, links and surface.
std::vector<Attachment> make_skin(const mesh::VolumeMesh& body, const fem::Material& material, const TetGraph& graph,
                                  const std::vector<int>& owner, const Model& model);

/// Nodes of the finite elements that `make_skin` takes of a body: all of a quadratic one, or of a large one its
/// corners.
double nodes_for_skin(double corners, double quadratic_nodes);

}  // namespace palpate::skeleton
