#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/identify.h"
#include "pipeline/case/case.h"

namespace palpate::pipeline {

/// What a run promised and did not keep, a sentence each. `compare`: as in compare.json.
std::vector<std::string> broken_expectations(const Expectation& expect, const nlohmann::json& compare,
                                             const std::vector<identify::PosteriorRow>& posterior, int spheres);

}  // namespace palpate::pipeline
