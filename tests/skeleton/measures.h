#pragma once

#include "mesh/geometry/surface_tree.h"
#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// What a skeleton's graph is like, and how it lies in its body.
struct Measures {
    int free = 0, held = 0, links = 0;
    int components = 0;  // of the graph
    int loops = 0;  // of its complex, first Betti number: triangles and quadrangles of links within the body filled
    int tips = 0;   // free spheres with one link
    int duplicates = 0;       // links that join the same two spheres as another, or a sphere with itself
    double coverage = 0;      // of vertices that no support holds, outside the spheres, largest [mm]
    double worst_link = 0;    // how far links lie outside the body, largest [mm]
    double worst_center = 0;  // how far free centres lie outside the body, largest [mm]
};

Measures measure(const Model& model, const mesh::SurfaceTree& tree);

/// How far spheres are from where a reflection has them: root of the mean squared distance from each free sphere's
/// image to the nearest sphere, over the mean distance of neighbours. A random pattern has about 0.5.
double asymmetry(const Model& model, const Vec3& normal, const Vec3& middle);

/// Number of handles of a body within a closed surface: the sum of the genera of its shells.
int handles(const mesh::Surface& surface);

}  // namespace palpate::skeleton
