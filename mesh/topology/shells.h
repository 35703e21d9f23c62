#pragma once

#include <vector>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// A closed part of a surface that hangs together by its edges.
struct Shell {
    Surface surface;             // its triangles alone, in their order
    std::vector<int> triangles;  // their rows in the whole surface
    double volume = 0;           // signed [mm^3]
    int depth = 0;               // how many other shells hold it: odd ones are cavities
    bool is_cavity() const { return depth % 2 == 1; }
};

/// For each triangle the number of its part (m), counted from 0; parts hang together by edges.
std::vector<int> connected_parts(const Surface& surface);

/// Each part alone, with the vertices that it uses.
std::vector<Surface> split_parts(const Surface& surface);

/// @pre the surface is closed and free of self-intersections.
std::vector<Shell> find_shells(const Surface& surface);

/// The same surface with every shell turned: bodies outwards, cavities inwards.
/// @pre as for `find_shells`.
Surface turn_outward(const Surface& surface);

/// A body with a closed surface, whichever way it is turned, as the wall of a cavity in it.
Surface with_cavity(Surface body, const Surface& wall);

/// What the shells enclose: bodies less cavities, whichever way they are turned [mm^3].
double enclosed_volume(const std::vector<Shell>& shells);

/// A point in each cavity, away from every shell (k x 3) [mm].
/// @throws SolverFailure when none was found.
Points cavity_points(const std::vector<Shell>& shells);

}  // namespace palpate::mesh
