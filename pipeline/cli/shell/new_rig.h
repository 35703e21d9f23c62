#pragma once

#include <string>
#include <vector>

#include "pipeline/command_line/commands.h"

namespace palpate::pipeline::commands {

/// The rigs that there is a set of, to start from.
const std::vector<std::string>& rig_names();

/// A commented measurement set of the second format, as such a rig writes it, with a small body; `palpate check`
/// accepts it. @pre options.rig is one of those; the folder is not there, or empty.
Outcome new_rig(const NewOptions& options);

}  // namespace palpate::pipeline::commands
