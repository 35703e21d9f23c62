#pragma once

#include <string>
#include <vector>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// What is wrong with a surface, counted; nothing is changed. Counts are after welding equal corners.
struct SurfaceReport {
    int vertices = 0, triangles = 0;
    int duplicate_vertices = 0;    // corners within 1e-6 of the diagonal of another one
    int degenerate_triangles = 0;  // no area
    int duplicate_triangles = 0;
    int boundary_edges = 0, holes = 0;
    int non_manifold_edges = 0;
    int non_manifold_vertices = 0;  // where parts of the surface touch in a point
    int inconsistent_edges = 0;     // neighbours that disagree about the outside
    int self_intersections = 0;     // pairs of triangles
    int components = 0;
    bool closed = false;
    bool outward = false;         // signed volume is positive
    double volume = 0, area = 0;  // [mm^3], [mm^2]
    Box box{};

    /// Can it be filled with tetrahedra as it is?
    bool sound() const;
};

enum class Fault {
    degenerate_triangle = 1,
    duplicate_triangle,
    non_manifold_edge,
    inconsistent_edge,
    hole,  // an open edge of it
    non_manifold_vertex,
    self_intersection
};

/// "triangle without area" and so on.
const char* name_of(Fault fault);

/// Where a fault is.
struct FaultPlace {
    Fault fault;
    Vec3 at;                     // [mm]
    std::vector<int> triangles;  // that have it, rows of the surface
};

/// @param places when asked for: every fault that is counted, in the order of the kinds.
SurfaceReport check_surface(const Surface& surface, std::vector<FaultPlace>* places = nullptr);

/// One sentence per fault: what, how many, and what `repair` does about it. Empty for a sound surface.
std::vector<std::string> describe_faults(const SurfaceReport& report);

}  // namespace palpate::mesh
