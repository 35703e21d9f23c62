#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"

namespace palpate::pipeline {

/// What a set is good for, before any fit.
struct PreflightOfSet {
    nlohmann::json preflight = nullptr;  // as in check.json; null: it could not be judged
    std::string why_none;                // then
};

/// On a coarse body of finite elements: some seconds. `set`: with the supports that hold it.
PreflightOfSet judge(const identify::MeasurementSet& set, int threads, const Progress& progress);

}  // namespace palpate::pipeline
