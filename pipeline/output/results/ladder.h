#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "identify/diagnosis/ladder/ladder.h"

namespace palpate::pipeline {

/// ladder.json.
nlohmann::json to_json(const identify::Ladder& ladder);

/// What ladder.json says: a line a step.
std::string ladder_in_words(const nlohmann::json& ladder);

/// compare.json of the last step's model and of the body fitted with its effects, both to all states.
nlohmann::json final_comparison(const identify::Ladder& ladder, const identify::BodyModel& body);

/// ladder.json, the last step's model as model.json and model.vtp with its posterior.csv and compare.json, the error of
/// every step as ladder.pvd, and the model that each step is judged by as step_N/model.json. `body`: that it was built
/// on.
void write_ladder(const std::filesystem::path& folder, const identify::Ladder& ladder, const identify::BodyModel& body);

}  // namespace palpate::pipeline
