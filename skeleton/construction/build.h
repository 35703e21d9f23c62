#pragma once

#include <string>
#include <vector>

#include "fem/material.h"
#include "mesh/core/region.h"
#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"
#include "skeleton/construction/build_options.h"
#include "skeleton/model/model.h"

namespace palpate::skeleton {

struct BuildReport {
    Points medial_centers;           // poles of the medial axis (n x 3) [mm]
    Eigen::VectorXd medial_radii;    // (n) [mm]
    double coverage = 0;             // largest distance of a vertex that no support holds outside the spheres [mm]
    std::vector<std::string> notes;  // what a user should know, in words
};

/// Mesh to skeleton: medial axis, filling spheres, links, masses, start stiffness, skin.
///
/// `surface`: closed, outward; `body`: its tetrahedra. Limbs become chains, plates layers, lumps are filled; a body may
/// be several of these. Free spheres reach to the surface, in lumps they are smaller; some swell through it by half of
/// the coverage at most, to reach edges. Held spheres stand where free material begins; cells of the body, one a
/// sphere, give masses, links and their sections. The same input gives the same model.
/// @throws InvalidInput when no support holds any of the body, or the spheres asked for cannot be placed.
Model build_skeleton(const mesh::Surface& surface, const mesh::VolumeMesh& body, const fem::Material& material,
                     const std::vector<mesh::Region>& supports, const BuildOptions& options,
                     BuildReport* report = nullptr);

}  // namespace palpate::skeleton
