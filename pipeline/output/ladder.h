#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "identify/diagnosis/ladder.h"

namespace palpate::pipeline {

/// ladder.json.
nlohmann::json to_json(const identify::Ladder& ladder);

/// What ladder.json says: a line a step.
std::string ladder_in_words(const nlohmann::json& ladder);

/// ladder.json, the last step's model as model.json and model.vtp with its posterior.csv, the error of every step as
/// ladder.pvd, and the model that each step is judged by as step_N/model.json.
void write_ladder(const std::filesystem::path& folder, const identify::Ladder& ladder);

}  // namespace palpate::pipeline
