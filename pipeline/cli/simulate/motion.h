#pragma once

#include "pipeline/command_line/commands.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline::commands {

/// Plays each probe as motion, a frame every `dt`, and writes the skin, frame by frame. @pre options.dt and duration
/// @throws InvalidInput where the model has no skin.
Outcome simulate_motion(const SimulateOptions& options, const skeleton::Model& model,
                        const std::filesystem::path& output);

}  // namespace palpate::pipeline::commands
