#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "mesh/core/surface.h"

namespace palpate::bench {

/// A way to break a surface, and what body is still to be seen in it.
struct Break {
    const char* name;
    /// The broken surface; deterministic.
    std::function<mesh::Surface(const mesh::Surface&)> apply;
    /// Is the body still to be recognised, so that a mesh is wanted rather than a message?
    bool is_recognisable = true;
    /// Does another body, a ball, lap over it?
    bool has_ball = false;
    double offset = 0;         // from the origin, in diagonals
    bool moves_walls = false;  // its volume is that which it encloses itself: thin walls change theirs
};

/// The ten ways but truncation, which breaks a file.
std::vector<Break> breaks();

/// The ball that overlaps a body: round its first vertex, a tenth of its diagonal in radius.
mesh::Surface overlapping_ball(const mesh::Surface& surface);

}  // namespace palpate::bench
