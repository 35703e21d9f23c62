#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "mesh/formats/deck/deck.h"
#include "mesh/formats/solution/solution.h"

namespace palpate::pipeline {

/// One field in a folder of another solver's results: the file, and which of its steps.
struct FieldPlace {
    std::filesystem::path file;
    std::optional<std::size_t> step = {};  // absent: the last

    const mesh::SolvedStep& in(const mesh::Solution& solution) const {
        return step ? solution.steps[*step] : solution.steps.back();
    }
};

/// What another solver left in a folder: fields, the loads behind them, and perhaps the deck that it read.
struct ResultsFolder {
    std::filesystem::path folder;
    std::optional<mesh::Deck> deck;           // of the only .inp file, or the one that a results file is named after
    std::vector<identify::LoadState> states;  // with their contacts [mm, N], without readings
    std::vector<FieldPlace> fields;           // of each state
    std::vector<std::string> notes;           // what was found and left out, in words

    mesh::Solution read(const std::filesystem::path& file, const std::string& array) const;
};

/// Looks through a folder. Loads are those of its probes.csv, else of the deck's steps. Files that are called
/// <probe>_<time> belong to that state, by their last step; others stand in the order of their names (2 before 10),
/// their steps in the order of the file, and there must be as many as states. Of several increments of one step the
/// last counts. `unit`: of the solver's lengths [mm]. @throws IoError, InvalidInput.
ResultsFolder scan_results(const std::filesystem::path& folder, double unit, const std::string& array);

}  // namespace palpate::pipeline
