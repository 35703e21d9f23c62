#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "identify/models/reference/reference_body.h"
#include "mesh/progress.h"

namespace palpate::pipeline {

/// Quadratic nodes of a reference body by default, where it is stout: finer ones change its answers by less than
/// contacts are known, and a diagnosis factors hundreds of tangents, at a cost that grows with the square of the nodes.
inline constexpr int reference_nodes = 2500;

/// Edge length of a reference body's elements by default [mm]: 7 % of the longest side, or, for a stout body, what
/// makes some `reference_nodes`.
double reference_edge_length(const mesh::Surface& surface);

/// How quadratic elements of such an edge length [mm] are to keep their volume in a body: by the mean dilatation, with
/// which a sheet of one element in thickness would bend too easily (ElementModel::local_bulk); as thin ones where one
/// of them is all there is in the body's thickness.
fem::Dilatation dilatation_for(const mesh::Surface& surface, double edge_length);

/// The body of a measurement set in finite elements, or why there is none.
struct Reference {
    std::unique_ptr<identify::ReferenceBody> body;  // empty: it cannot be made
    std::string why_none;                           // then
    std::vector<std::string> notes;                 // what a user should know, in words
};

/// Repairs and remeshes the set's rest surface, fills it with quadratic tetrahedra, and curves them to the surface.
/// Tetrahedra of the set's own are used as they are.
/// Density and a first guess of Young's modulus are the set's.
/// @param edge_length of the tetrahedra [mm]; 0: the default
/// @param priors of its material, from other specimens
Reference make_reference(const identify::MeasurementSet& set, double edge_length, const Progress& progress = {},
                         const std::vector<identify::InformativePrior>& priors = {});

}  // namespace palpate::pipeline
