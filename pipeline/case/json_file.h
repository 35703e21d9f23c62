#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace palpate::pipeline {

/// What a JSON file holds. @throws IoError when there is no such file, InvalidInput when it is no JSON.
nlohmann::json json_of_file(const std::filesystem::path& file);

}  // namespace palpate::pipeline
