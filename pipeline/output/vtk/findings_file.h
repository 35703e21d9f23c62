#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "identify/measurements/measurement_set.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// What was found to be missing, drawn in the body at rest: triangles, with the number of the finding in "finding" and
/// what it is in "kind" (0 an arrow, 1 an axis, 2 a ball, 3 a plane, 4 springs, 5 markers that look swapped), and in
/// "ratio" the stiffness of a part over that of the rest (1 where a finding is none).
/// `diagnosis`: as in diagnosis.json, or null. Removes the file where there is nothing to draw. @throws IoError.
void write_findings(const std::filesystem::path& file, const skeleton::Model& model,
                    const identify::MeasurementSet& set, const nlohmann::json& diagnosis);

}  // namespace palpate::pipeline
