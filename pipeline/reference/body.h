#pragma once

#include <string>
#include <vector>

#include "mesh/progress.h"
#include "mesh/region.h"
#include "mesh/surface.h"
#include "mesh/volume_mesh.h"

namespace palpate::pipeline {

struct Subject;

struct BodyOptions {
    double edge_length = 0;  // of the tetrahedra [mm]; 0: 6 % of the longest side
    bool linear_elements = false;
    double volume_change = 0.01;  // that remeshing may make, as a share: chords of a round body cut volume off
};

/// A body ready for finite elements.
struct Body {
    mesh::Surface repaired;          // as it came, made closed
    mesh::Surface surface;           // that, remeshed
    mesh::VolumeMesh volume;         // quadratic, unless linear elements were asked for
    bool is_ready_made = false;      // the elements are those of a file
    std::vector<std::string> notes;  // what was done to the surface, in words
};

/// Surface to body: repair, remesh, fill with tetrahedra.
/// @throws InvalidInput, SolverFailure with what to do.
Body make_body(const mesh::Surface& surface, const BodyOptions& options, const Progress& progress = {});

/// The same of a subject; a ready-made mesh is used as it is, with midside nodes unless linear elements were asked for.
/// @throws InvalidInput where the boundary of a ready-made mesh crosses itself or meets itself along an edge.
Body make_body(const Subject& subject, const BodyOptions& options, const Progress& progress = {});

/// Share of the longest side that elements are long by default.
inline constexpr double default_edge_share = 0.06;

/// The clamp of a bare mesh: the 5 % of its length at the low end of its longest axis.
mesh::BoxRegion default_clamp(const mesh::Box& box);

}  // namespace palpate::pipeline
