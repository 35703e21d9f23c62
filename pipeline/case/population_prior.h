#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "identify/inference/priors/informative_prior.h"

namespace palpate::pipeline {

/// What the specimens of a population let expect of the next one's stiffness, by population.json, a file or in a folder
/// (`palpate pool -o`). Effects are not among it: each specimen has its own. @throws IoError, InvalidInput naming the
/// file, where it is no population or tells no stiffness.
std::vector<identify::InformativePrior> read_population_prior(const std::filesystem::path& population);

/// The same as a key of what was computed with them.
nlohmann::json priors_json(const std::vector<identify::InformativePrior>& priors);

}  // namespace palpate::pipeline
