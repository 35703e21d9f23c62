#pragma once

#include <nlohmann/json.hpp>

#include "identify/models/reference/reference_body.h"
#include "identify/preflight/preflight.h"

namespace palpate::pipeline {

/// What `palpate check` finds out about a set before a fit, as check.json holds it under "preflight".
nlohmann::json to_json(const identify::Preflight& preflight, const identify::ReferenceBody& body,
                       const identify::MeasurementSet& set);

}  // namespace palpate::pipeline
