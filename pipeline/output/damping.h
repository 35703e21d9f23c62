#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "identify/motion/damping_result.h"

namespace palpate::pipeline {

/// What identify.json states about damping.
nlohmann::json to_json(const identify::DampingResult& found);

/// Where each recording moves most, measured and played, as damping.csv.
std::string damping_csv(const identify::DampingResult& found);

/// "3.1 (2.9 to 3.3)": what is known of a number, the median and 95 %.
std::string interval_in_words(const nlohmann::json& known);

/// How damping goes with frequency, in words.
std::string how_it_goes(const nlohmann::json& damping);

/// What identify.json states about damping, for the terminal: a sentence, and a line a mode.
std::string damping_in_words(const nlohmann::json& damping);

}  // namespace palpate::pipeline
