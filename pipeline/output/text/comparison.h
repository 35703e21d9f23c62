#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace palpate::pipeline {

/// What compare.json says, in sentences.
std::string compare_in_words(const nlohmann::json& compare);

}  // namespace palpate::pipeline
