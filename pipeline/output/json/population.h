#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "pipeline/analysis/specimens.h"

namespace palpate::pipeline {

/// population.json: each number that specimens share, with what they come to together; in their own units.
nlohmann::json population_json(const std::vector<SharedNumber>& numbers,
                               const std::vector<identify::PooledNumber>& pooled);

}  // namespace palpate::pipeline
