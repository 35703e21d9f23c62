#pragma once

#include <vector>

#include "mesh/core/surface.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::mesh {

/// Which of several closed surfaces, disjoint or nested, holds a point. Safe from several threads.
class RegionFinder {
public:
    explicit RegionFinder(const std::vector<Surface>& surfaces);
    /// By place among the surfaces; of nested ones the innermost; -1: none.
    int operator()(const Vec3& point) const;

private:
    struct Part {
        int place;
        Box box;
        SurfaceTree tree;
    };
    std::vector<Part> parts_;  // from the smallest to the largest: what lies within another one is smaller
};

}  // namespace palpate::mesh
