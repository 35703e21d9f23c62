#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "identify/diagnosis/diagnosis.h"

namespace palpate::pipeline {

/// diagnosis.json. `set`: that was diagnosed on `model`. `field`: the series of what is missing, beside it; empty: none
/// was written.
nlohmann::json to_json(const identify::Diagnosis& diagnosis, const identify::BodyModel& model,
                       const identify::MeasurementSet& set, const std::string& field = {});

}  // namespace palpate::pipeline
