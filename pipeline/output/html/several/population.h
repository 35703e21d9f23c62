#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace palpate::pipeline {

/// population.json as one self-contained page, with a forest plot for each number.
void write_population_page(const std::filesystem::path& page, const nlohmann::json& population);

}  // namespace palpate::pipeline
