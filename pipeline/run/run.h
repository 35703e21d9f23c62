#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/case/settings/overrides.h"
#include "pipeline/command_line/terminal/outcome.h"

namespace palpate::pipeline::commands {

struct RunOptions {
    std::filesystem::path input, output;
    CaseOverrides overrides;
};
/// Several runs with the same settings, by Snakemake.
struct BatchOptions {
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path output;
    std::string workers;  // "local:2", "slurm", ...: see parse_workers
    CaseOverrides overrides;
};
Outcome run_batch(const BatchOptions& options, const Common& common);

/// The whole job: mesh, skeleton, measurements, identification, diagnosis, comparison, improvement, report.
Outcome run(const RunOptions& options, const Common& common);

}  // namespace palpate::pipeline::commands
