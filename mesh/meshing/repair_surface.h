#pragma once

#include <string>
#include <vector>

#include "mesh/core/surface.h"

namespace palpate::mesh {

struct RepairOptions {
    double weld = 1e-6;  // corners closer than this share of the diagonal become one, (0, 0.01]
    double largest_hole =
        0.25;  // holes whose box diagonal is larger than this share of the body's are not filled, [0, 1]
    double largest_flat_hole = 0.6;  // the same for holes whose border lies in a plane, [0, 1]
    double allowed_distance = 0.02;  // the result may lie this far from the input, as a share of the diagonal
    bool wrap = false;               // wrap it, sound or not
    bool may_wrap = true;            // false: refused where nothing else makes it sound
    void validate() const;
};

struct RepairResult {
    Surface surface;                 // closed, outward, free of self-intersections
    std::vector<std::string> steps;  // what was done, in words and counts; empty: nothing
    double distance = 0;             // from the input's vertices to the result, largest [mm]
    double volume = 0;               // [mm^3]
    bool wrapped = false;            // alpha wrapping was needed
};

/// Weld, orient, stitch, fill small holes, remove self-intersections; alpha wrapping as the last resort.
/// A sound surface comes back unchanged but for welding.
/// @throws InvalidInput when the surface encloses no volume, or the result strays from the input by more than
/// allowed; the message says which and what to do.
RepairResult repair_surface(const Surface& surface, const RepairOptions& options = {});

}  // namespace palpate::mesh
