#pragma once

#include <nlohmann/json.hpp>

#include "identify/models/reference_body.h"
#include "identify/preflight/preflight.h"

namespace palpate::pipeline {

/// An effect counts as one that a set can show where it could be named in at least this share of the cases that its
/// prior expects (locations, directions) [-]: the set is then more likely to show it than not.
inline constexpr double sufficient_share = 0.5;

/// What `palpate check` finds out about a set before a fit, as check.json holds it under "preflight".
nlohmann::json to_json(const identify::Preflight& preflight, const identify::ReferenceBody& body,
                       const identify::MeasurementSet& set);

}  // namespace palpate::pipeline
