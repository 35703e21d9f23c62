#pragma once

#include <filesystem>

#include "pipeline/synthesis/loading/load_plan.h"

namespace palpate::pipeline {

/// A folder for the user's own solver: body.inp (Abaqus, CalculiX) with a step for each state of the plan, and
/// probes.csv, which tells their loads to `palpate probe --from`. How many states there are. @throws IoError.
int write_deck(const std::filesystem::path& folder, const Specimen& specimen, const Plan& plan);

}  // namespace palpate::pipeline
