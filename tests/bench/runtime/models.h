#pragma once

#include "skeleton/model/model.h"
#include "skeleton/runtime/body.h"

namespace palpate::bench {

/// Spheres in a row, 10 mm apart, the first held; links of the paper's kind, or full ones with volumes.
skeleton::Model chain(int links, bool full);
/// A block of n spheres each way, 10 mm apart, linked to their neighbours, held at x = 0.
skeleton::Model lattice(const Eigen::Vector3i& n, bool full);
/// The same with spheres and links in random order.
skeleton::Model shuffled(skeleton::Model model);
/// Nothing held.
skeleton::Model free(skeleton::Model model);
/// An ellipsoid filled with about so many spheres, full links and volumes. Each vertex of its skin, an icosahedron
/// whose edges were halved so often (5: 10,242 vertices), hangs on the six spheres nearest to it.
skeleton::Model organ(int spheres, int halvings);
/// A small triangle of skin on each free sphere, so that it can be pushed.
skeleton::Model with_skin_on_spheres(skeleton::Model model);
/// A force on the last sphere that moves it by that share of the body's size, in the linear answer.
Vec3 force_for(const skeleton::Model& model, double share);

void set_off(runtime::Body& body, double speed, double spin);

}  // namespace palpate::bench
