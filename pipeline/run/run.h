#pragma once

#include "pipeline/case/settings/overrides.h"
#include "pipeline/command_line/terminal/outcome.h"

namespace palpate::pipeline::commands {

struct RunOptions {
    std::filesystem::path input, output;
    CaseOverrides overrides;
};
/// The whole job: mesh, skeleton, measurements, identification, diagnosis, comparison, improvement, report.
Outcome run(const RunOptions& options, const Common& common);

}  // namespace palpate::pipeline::commands
