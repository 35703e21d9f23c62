#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "identify/inference/posterior_row.h"

namespace palpate::pipeline {

/// posterior.csv: a row per identified number.
std::string posterior_csv(const std::vector<identify::PosteriorRow>& rows);

/// @throws IoError, InvalidInput naming file and line.
std::vector<identify::PosteriorRow> read_posterior(const std::filesystem::path& file);

}  // namespace palpate::pipeline
