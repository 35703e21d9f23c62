#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace palpate::pipeline {

/// A row of the comparison of runs.
struct RunNumber {
    std::string name;
    std::vector<std::string> of_runs;  // in words; "–" where a run has none
    std::optional<std::size_t> best;   // the run that is best in it, where runs can be compared
};

/// Are all runs of the same body, loads and readings, so that the least error is the best?
bool can_be_ranked(const nlohmann::json& runs);

/// The numbers of runs side by side, of runs_json.
std::vector<RunNumber> run_numbers(const nlohmann::json& runs);

/// Which run is nearest to its measurements, and by what; or why that cannot be determined.
std::string best_run_in_words(const nlohmann::json& runs);

/// The same for a terminal, with the settings that differ.
std::string runs_table(const nlohmann::json& runs);

}  // namespace palpate::pipeline
