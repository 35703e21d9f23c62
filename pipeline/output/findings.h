#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "skeleton/effects/effect.h"

namespace palpate::pipeline {

/// What of a model's effects can be drawn in the body, as html/page/findings.js and vtk/findings_file.h draw it: an
/// {effect, words, kind} each, with what its kind has: "arrow" (gravity) and "axis" (fibres) a `vector`, of an arrow
/// without its `undetermined` components, each an {axis, value, sd}; "ball" (an inclusion, a part of a map of
/// stiffness, a force on a part) `center`, `radius` and, of a force, its `vector`, else `ratio`, its stiffness over
/// that of the rest; "plane" (contact) `vector`, its normal, and `offset`; "springs" (a compliant support) and "words"
/// nothing. `effect` is empty for what no effect is named for.
/// `diagnosis`: as in diagnosis.json, or null; states which components of a vector are determined.
nlohmann::json findings_json(const std::vector<skeleton::EffectRecord>& effects, const nlohmann::json& diagnosis);

}  // namespace palpate::pipeline
