#pragma once

#include <string>
#include <vector>

#include "mesh/core/material_region.h"
#include "mesh/core/region.h"
#include "mesh/core/surface.h"
#include "mesh/core/tool.h"
#include "mesh/core/volume_mesh.h"
#include "mesh/progress.h"
#include "pipeline/body/contact_zones.h"

namespace palpate::pipeline {

struct MeshingOptions {
    double edge_length = 0;  // of the tetrahedra [mm]; 0: 6 % of the longest side, less in a thin body
    bool linear_elements = false;
    std::vector<FineZone> fine = {};                 // where edges are shorter
    std::vector<mesh::MaterialRegion> regions = {};  // whose surfaces elements end at
    std::vector<mesh::Region> held = {};             // supports and grips, at whose borders elements end, too
    double volume_change = 0.01;  // that remeshing may make, as a share: chords of a round body cut volume off
};

/// A body ready for finite elements.
struct MeshedBody {
    mesh::Surface repaired;                      // as it came, made closed
    mesh::Surface surface;                       // that, remeshed
    std::vector<mesh::Surface> interfaces = {};  // of the regions, as elements follow them
    mesh::VolumeMesh volume;                     // quadratic, unless linear elements were asked for
    bool is_ready_made = false;                  // the elements are those of a file
    std::vector<std::string> notes;              // what was done to the surface, in words
};

/// Surface to body: repair, remesh, fill with tetrahedra.
/// @throws InvalidInput, SolverFailure with what to do.
MeshedBody make_body(const mesh::Surface& surface, const MeshingOptions& options, const Progress& progress = {});

/// A ready-made mesh behind its boundary as a body: used as it is, with midside nodes unless linear elements were asked
/// for. @throws InvalidInput where the boundary crosses itself or meets itself along an edge.
MeshedBody ready_made_body(const mesh::VolumeMesh& mesh, const mesh::Surface& boundary, const MeshingOptions& options);

/// The regions with their surfaces as a body's elements follow them.
std::vector<mesh::MaterialRegion> with_surfaces(std::vector<mesh::MaterialRegion> regions,
                                                const std::vector<mesh::Surface>& interfaces);

/// What a rig holds or moves as one: the supports and what its tools grip.
std::vector<mesh::Region> held_regions(std::vector<mesh::Region> supports, const std::vector<mesh::Tool>& tools);

/// Elements by default: 6 % of the longest side, and shorter where the body is thinner (`edge_for_thickness`) [mm].
double default_edge_length(const mesh::Surface& surface);

/// How thick a closed body is on average, 2 V / A [mm].
double thickness_of(const mesh::Surface& surface);

/// The edge length, no longer than `edge`, at which a thin body bends as it should: elements are at most four times as
/// long as the body is thick on average, 2 V / A, as far as `nodes` quadratic nodes allow [mm].
double edge_for_thickness(const mesh::Surface& surface, double edge, double nodes);

/// Edge length of a thin body with about so many quadratic nodes, one element through the thickness [mm].
double edge_of_sheet(const mesh::Surface& surface, double nodes);

/// The clamp of a bare mesh: the 5 % of its length at the low end of its longest axis.
mesh::BoxRegion default_clamp(const mesh::Box& box);

}  // namespace palpate::pipeline
