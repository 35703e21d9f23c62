#pragma once

#include <functional>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// The surface with edges halved until none is longer than `edge_at` its middle [mm]: those first that are too long by
/// the largest factor, with both triangles beside them, so that a closed surface stays one. New vertices come after the
/// old ones, and lie on the old triangles. @pre every edge has two triangles; edge_at is above 0.
Surface refine_surface(const Surface& surface, const std::function<double(const Vec3&)>& edge_at);

}  // namespace palpate::mesh
