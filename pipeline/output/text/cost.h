#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/analysis/cost/cost.h"

namespace palpate::pipeline {

/// `cost` of check.json.
nlohmann::json to_json(const std::vector<StageCost>& stages, const WorkSize& size, int threads);

/// What a stage, or all of them, would take: "40 s", "40 s, up to 2 min".
std::string duration_in_words(const nlohmann::json& stage);

/// All of it in a sentence: time, memory, size.
std::string cost_lead(const nlohmann::json& cost);

/// The same as a table, with what to do where memory does not suffice. `input`: with its flags, as the user gave them.
std::string cost_in_words(const nlohmann::json& cost, const std::string& input);

}  // namespace palpate::pipeline
