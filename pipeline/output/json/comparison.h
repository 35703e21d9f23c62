#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/comparison/comparison.h"
#include "identify/inference/identify_result.h"
#include "mesh/topology/check_surface.h"

namespace palpate::pipeline {

/// Machine-read results, as `--json` prints them and files hold them.
nlohmann::json to_json(const identify::Comparison& comparison, const identify::MeasurementSet& set);
/// Its worst probes, as a share of their displacement: where they press, and how far from the material that is held.
nlohmann::json worst_probes_json(const identify::Comparison& comparison, const identify::MeasurementSet& set);
nlohmann::json to_json(const mesh::SurfaceReport& report);
nlohmann::json summary_json(const identify::IdentifyResult& result);

}  // namespace palpate::pipeline
