#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/output/html/run_files.h"

namespace palpate::pipeline {

struct NamedRun {
    std::string name;
    RunFiles files;
};

/// Runs side by side, as runs.schema.json specifies: their errors, their settings where these differ, whether they are
/// of the same readings, and the error of each state where all have the same states.
nlohmann::json runs_json(const std::vector<NamedRun>& runs);

}  // namespace palpate::pipeline
