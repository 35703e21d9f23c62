#pragma once

#include "mesh/core/tool.h"

namespace palpate::mesh {

/// `share` times as much of a motion: of its translation and of its rotation vector.
inline ToolMotion scaled(ToolMotion motion, double share) {
    motion.translation *= share;
    motion.rotation *= share;
    return motion;
}

}  // namespace palpate::mesh
