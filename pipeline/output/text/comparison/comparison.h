#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace palpate::pipeline {

/// Were any positions read, or the forces of tools alone? `compare`: as compare.json.
bool reads_positions(const nlohmann::json& compare);

/// What compare.json says, in sentences. @param model what the first one begins with
std::string compare_in_words(const nlohmann::json& compare, const std::string& model = "The real-time model");

}  // namespace palpate::pipeline
