#pragma once

#include <nlohmann/json.hpp>

#include "identify/diagnosis/diagnosis.h"

namespace palpate::pipeline {

/// diagnosis.json. `set`: that was diagnosed on `model`.
nlohmann::json to_json(const identify::Diagnosis& diagnosis, const identify::BodyModel& model,
                       const identify::MeasurementSet& set);

}  // namespace palpate::pipeline
