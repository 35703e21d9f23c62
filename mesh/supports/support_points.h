#pragma once

#include <string>
#include <vector>

#include "mesh/core/region.h"
#include "mesh/core/surface.h"

namespace palpate::mesh {

struct PatchedSupports {
    std::vector<Region> regions;        // those given, in their order, then those that hold what is narrow
    std::vector<std::string> notes;     // what was made of them, in words
    std::vector<std::string> warnings;  // points that hold nothing
};

/// Supports that are given by points, as the patches that the points sample.
///
/// Who says that points are clamped means the surface that they lie on, whatever mesh the body gets. Points further
/// apart than `within` covers are joined (PointsRegion::joined), at most over the length of an element: no element
/// resolves the gap between them. Where the patch is narrower than an element, some of its points would hold no node:
/// there the region reaches half an element's length round the points, the distance between nodes of a quadratic one.
/// Other regions, and points of which `joined` is told, stay as they are.
/// @param edge_length of the elements that are to be held [mm]
/// @param name what the notes call a region, before its number
PatchedSupports patched(const std::vector<Region>& supports, const Surface& surface, double edge_length,
                        const std::string& name = "Support");

}  // namespace palpate::mesh
