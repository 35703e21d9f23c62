#pragma once

#include <string>
#include <vector>

#include "mesh/core/region.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

/// What a support holds of a body.
struct HeldPart {
    Eigen::Index nodes = 0;  // of the mesh, inside it and on its surface; of a surface its vertices
    double area = 0;         // of the surface [mm^2]
};

/// Of each region by itself; the surface is sampled `spacing` [mm] apart.
std::vector<HeldPart> held_parts(const std::vector<Region>& regions, const Surface& surface, double spacing);

/// Of each region by itself; area: of sides whose corners all are held.
std::vector<HeldPart> held_parts(const std::vector<Region>& regions, const VolumeMesh& mesh);

/// "1941 mm^2 of the surface".
std::string surface_in_words(double area);

/// "support 2 (points): 214 nodes, 380 mm^2 of the surface"
std::string describe_held_part(const std::vector<Region>& regions, const std::vector<HeldPart>& parts, std::size_t i,
                               const std::string& nodes);

/// What should be known before a body is held so: supports that hold nothing of it, or points alone and no side of an
/// element. An elastic solid held at points gives way without limit as elements get smaller, as the displacement under
/// a point force goes with 1 / r [Kelvin's solution]: the answer is the mesh's.
std::vector<std::string> too_little_held(const std::vector<Region>& regions, const VolumeMesh& mesh);

}  // namespace palpate::mesh
