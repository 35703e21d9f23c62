#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "skeleton/effects/effect.h"

namespace palpate::pipeline {

/// What of a model's effects can be drawn in the body, as page/findings.js draws it: an arrow (gravity), an axis
/// (fibres), a ball (an inclusion), a plane (contact), springs (a compliant support), each with its words.
/// `diagnosis`: as in diagnosis.json, or null; tells what of a vector is determined.
nlohmann::json findings_json(const std::vector<skeleton::EffectRecord>& effects, const nlohmann::json& diagnosis);

}  // namespace palpate::pipeline
