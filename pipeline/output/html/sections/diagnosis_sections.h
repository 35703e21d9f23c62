#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace palpate::pipeline {

// Sections of the report page on what a model lacks; "" where a run did not ask.

/// The candidates with their evidence. `diagnosis`: as in diagnosis.json, or null.
std::string missing_section(const nlohmann::json& diagnosis);

/// Errors before and after, of skeleton and reference body, fitted and held out. `ladder`: as in ladder.json, or null.
std::string ladder_section(const nlohmann::json& ladder, const nlohmann::json& compare);

/// What the error is made of. `compare`: as in compare.json; `improved`: the same with all effects in, or null.
std::string budget_section(const nlohmann::json& compare, const nlohmann::json& improved);

}  // namespace palpate::pipeline
