#pragma once

#include <nlohmann/json.hpp>

#include "identify/comparison/comparison.h"
#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/material_estimate.h"

namespace palpate::pipeline {

/// What compare.json says of the body in finite elements beside the skeleton: "reference", "baseline", "budget",
/// "regions", and how strange each marker is.
/// @param fit of the reference body to the problem
/// @param set, comparison of the skeleton
void add_reference(nlohmann::json& compare, const identify::BodyModel& reference, const identify::Problem& problem,
                   const identify::Refit& fit, const identify::MeasurementSet& set,
                   const identify::Comparison& comparison);

/// There is no reference body, and so no budget: the keys are there, and null.
void add_no_reference(nlohmann::json& compare, const std::string& why_none);

/// Where finite elements made the measurements themselves, they explain all but the noise.
void add_own_reference(nlohmann::json& compare, double noise);

/// "law", "young_mpa", "poisson", with their standard deviations; "poisson_declared": the set states the ratio.
nlohmann::json to_json(const identify::MaterialEstimate& material);

/// Law and numbers of a fit without further effects. `poisson` is null for a model that has none.
nlohmann::json baseline_json(const identify::BodyModel& model, const identify::Problem& problem,
                             const identify::Refit& fit);

}  // namespace palpate::pipeline
