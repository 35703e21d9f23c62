#pragma once

#include "pipeline/case/subject/subject.h"
#include "pipeline/command_line/terminal/outcome.h"

namespace palpate::pipeline::commands {

/// What each support holds of the surface, and of a ready-made mesh whether that is enough.
void add_supports(const Subject& subject, Outcome& outcome);

/// What each grip holds of the surface, and of a ready-made mesh. @pre add_supports, and a set
void add_grips(const Subject& subject, Outcome& outcome);

}  // namespace palpate::pipeline::commands
