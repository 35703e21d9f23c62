#pragma once

#include <string>
#include <string_view>

#include "mesh/surface.h"

namespace palpate::mesh {

/// A surface as bytes, to come back from a child process: two counts, the vertices, the triangles.
std::string to_bytes(const Surface& surface);

/// The surface behind such bytes; empty where they are none.
Surface surface_from_bytes(std::string_view bytes);

}  // namespace palpate::mesh
