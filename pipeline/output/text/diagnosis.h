#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace palpate::pipeline {

/// What diagnosis.json says, in sentences.
std::string diagnosis_in_words(const nlohmann::json& diagnosis);

}  // namespace palpate::pipeline
