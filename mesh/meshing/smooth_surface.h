#pragma once

#include <vector>

#include "mesh/core/region.h"
#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

struct SmoothSurfaceOptions {
    double crease_angle = 60;       // edges sharper than this stay sharp [degrees], (0, 180)
    std::vector<Region> held = {};  // whose nodes stay within them
    void validate() const;
};

/// The smooth body behind a faceted one: boundary nodes of a body of quadratic tetrahedra are moved from the facets of
/// `surface` to the smooth surface that its vertices are taken to lie on, inner nodes follow.
///
/// Each edge of the surface gets a midpoint off the chord d: by the normals at its ends,
/// -((d.n_a) n_a - (d.n_b) n_b) / (4 h (1 + h)), h = |n_a + n_b|/2 [cf. Vlachos et al. 2001; h makes arcs exact], along
/// creases by their tangents; triangles bulge quadratically between. Facets of a scan or an STL file are chords of the
/// true surface, and a body cut by chords is up to a tenth too soft.
/// Elements that would turn inside out stay straighter. Linear elements are returned as they are.
/// @throws InvalidInput for options out of range.
VolumeMesh curve_to(const VolumeMesh& body, const Surface& surface, const SmoothSurfaceOptions& options = {});

}  // namespace palpate::mesh
