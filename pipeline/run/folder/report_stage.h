#pragma once

#include <string>

#include "pipeline/run/folder/run_folder.h"

namespace palpate::pipeline::commands {

/// Says on a line what a stage came to, and how long it took.
void report_stage(const RunFolder& folder, const std::string& stage, bool ran, const std::string& what);

}  // namespace palpate::pipeline::commands
