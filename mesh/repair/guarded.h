#pragma once

#include <functional>
#include <optional>

#include "mesh/surface.h"

namespace palpate::mesh {

/// What a step comes to in a child process with limits on time (5 minutes) and memory (8 GiB): broken surfaces lead
/// CGAL into endless loops and beyond arrays. Nothing where it crashed, did not end, threw, or left no triangle.
std::optional<Surface> guarded(const std::function<Surface()>& step);

}  // namespace palpate::mesh
