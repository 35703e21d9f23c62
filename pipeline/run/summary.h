#pragma once

#include "pipeline/case/subject/subject.h"
#include "pipeline/command_line/terminal/outcome.h"
#include "pipeline/run/expectation.h"
#include "pipeline/run/folder/run_folder.h"

namespace palpate::pipeline::commands {

/// What a run came to: how wrong, what is missing, the ladder, where to look, what to type next, and which of the
/// case's expectations are not met.
Outcome outcome_of(const Subject& subject, const RunResults& results, const RunFolder& folder);

}  // namespace palpate::pipeline::commands
