#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/analysis/specimens.h"

namespace palpate::pipeline {

/// What two runs or more tell: stiffness of the body in finite elements and of the skeleton, and the numbers of the
/// effects that their diagnoses name. @throws IoError, InvalidInput naming the run, for less than two runs, one that is
/// told twice, or runs that share no number.
std::vector<SharedNumber> shared_numbers(const std::vector<std::filesystem::path>& runs);

}  // namespace palpate::pipeline
