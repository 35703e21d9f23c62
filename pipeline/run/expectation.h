#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/inference/posterior_row.h"
#include "pipeline/case/case.h"

namespace palpate::pipeline {

/// What a run came to.
struct RunResults {
    nlohmann::json compare;              // as in compare.json
    nlohmann::json diagnosis = nullptr;  // as in diagnosis.json; null: it was not asked
    nlohmann::json ladder = nullptr;     // as in ladder.json; null: likewise
    nlohmann::json improved = nullptr;   // as in improve/compare.json; null: nothing was added
    std::vector<identify::PosteriorRow> posterior = {};
    nlohmann::json modes = nullptr;    // as in identify.json
    nlohmann::json damping = nullptr;  // as in identify.json; null: the set holds no motion
    int spheres = 0, links = 0;
};

/// What a run promised and did not keep, a sentence each.
std::vector<std::string> broken_expectations(const Expectation& expect, const RunResults& results);

}  // namespace palpate::pipeline
