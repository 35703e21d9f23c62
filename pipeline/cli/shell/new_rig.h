#pragma once

#include <string>
#include <vector>

#include "pipeline/command_line/commands.h"

namespace palpate::pipeline::commands {

/// The rigs that there is a set of, to start from.
const std::vector<std::string>& rig_names();

/// An empty measurement set to fill in, commented, with a bar in the body's place. @pre as for new_rig.
Outcome new_measurements(const NewOptions& options);

/// A commented measurement set of the second format, as such a rig writes it, with a small body; `palpate check`
/// accepts it. @pre options.rig is one of those; the folder is not there, or empty.
Outcome new_rig(const NewOptions& options);

}  // namespace palpate::pipeline::commands
