#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "pipeline/output/vtk/population_map.h"

namespace palpate::pipeline {

/// population.json as one self-contained page, with a forest plot for each number, and maps over the
/// links of the mean specimen, where there is one.
void write_population_page(const std::filesystem::path& page, const nlohmann::json& population,
                           const skeleton::Model* mean = nullptr, const std::vector<LinkMap>& maps = {});

}  // namespace palpate::pipeline
