#pragma once

#include <filesystem>

#include "identify/inference/identify_result.h"

namespace palpate::pipeline {

/// model.json, model.vtp, posterior.csv, particles.csv, correlations.csv, convergence.csv, identify.json and the
/// particle history (history.pvd) of an identification.
void write_identification(const std::filesystem::path& folder, const identify::IdentifyResult& found);

}  // namespace palpate::pipeline
