#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace palpate::pipeline {

/// What compare.json says, in sentences. @param model what the first one begins with
std::string compare_in_words(const nlohmann::json& compare, const std::string& model = "The model");

}  // namespace palpate::pipeline
