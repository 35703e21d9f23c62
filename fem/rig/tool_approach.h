#pragma once

#include <optional>

#include "fem/rig/tool_potential.h"

namespace palpate::fem {

/// A tool that comes to its pose from off the body, against the mean normal of what it presses in, rather than from
/// rest. Where it rests on the other side, or a long way along the body, the straight way from there leads through it.
struct ToolApproach {
    std::shared_ptr<const ToolPotential> tool;  // in its pose, part way out of the body
    /// Does it come this way, by all that the pose tells? Else it may as well have pushed from rest a body that is
    /// thinner than it was moved by, and been stopped on its far side.
    bool likely = false;
};

/// `surface`: (n, 3), points of the body's surface at rest [mm]; `normals`: (n, 3), outward there, of any length;
/// `held`: (m, 3), points that do not move. None where nothing of the surface lies within the tool, or where it does
/// not come free of the body, outside of it, within its way from rest.
std::optional<ToolApproach> from_off_the_body(const ToolPotential& tool, const Points& surface, const Points& normals,
                                              const Points& held);

}  // namespace palpate::fem
