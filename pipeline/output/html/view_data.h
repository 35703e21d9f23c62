#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "identify/inference/posterior_row.h"

namespace palpate::pipeline {

/// What the page's three-dimensional view shows, as page/data.js reads it: the body at rest, its states, and for each
/// step of the ladder (or for the one model that there is) how the model answers them. Null where the run has no such
/// series.
///
/// `compare`, `ladder`, `diagnosis`: as in the files of these names, the last two may be null. `posterior`: of the last
/// step. Arrays are in base64; shapes are cut into 65,535 levels. Of more states than fit into `budget` bytes those
/// with the largest errors are kept, and "left_out" states how many are not. Tools (view_tools.h) are those of the set
/// that case.yaml names, where it is still there.
/// @throws IoError, InvalidInput when a file of a series is missing or broken.
nlohmann::json view_data(const std::filesystem::path& run, const nlohmann::json& record, const nlohmann::json& compare,
                         const nlohmann::json& ladder, const nlohmann::json& diagnosis,
                         const std::vector<identify::PosteriorRow>& posterior, std::size_t budget = 3'000'000);

}  // namespace palpate::pipeline
