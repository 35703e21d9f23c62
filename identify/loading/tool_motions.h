#pragma once

#include "mesh/core/tool.h"

namespace palpate::identify {

/// May a tool part from the body? Else it holds material, or is bonded to it.
bool may_part(const mesh::Tool& tool);

/// Does a motion take a tool that may part farther than it is wide, as one that comes from off the body or roams over
/// it? How far it presses is not what it has moved by then.
bool roams(const mesh::Tool& tool, const mesh::ToolMotion& motion);

}  // namespace palpate::identify
