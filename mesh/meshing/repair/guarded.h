#pragma once

#include <functional>
#include <optional>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// What a step on so many triangles comes to in a child process with limits on time and memory: broken surfaces lead
/// CGAL into endless loops and beyond arrays. Nothing where it crashed, did not end, threw, or left no triangle.
std::optional<Surface> guarded(Eigen::Index triangles, const std::function<Surface()>& step);

}  // namespace palpate::mesh
