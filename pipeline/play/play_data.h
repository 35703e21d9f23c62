#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::pipeline {

/// What a page plays: models, and where there is one the set that they are judged by.
struct PlayData {
    std::string name;
    nlohmann::ordered_json content;  // as page/player.js reads it
    std::vector<std::string> notes;  // what is not played as it stands, in sentences
    std::size_t models = 0, states = 0;
};

/// `input`: a model.json, a folder of identify or improve, or a run folder. `set`: measurements; empty: the run's own,
/// where it has some that can still be read.
/// @throws IoError, InvalidInput naming the file that is missing or cannot be played.
PlayData play_data(const std::filesystem::path& input, const std::filesystem::path& set);

}  // namespace palpate::pipeline
