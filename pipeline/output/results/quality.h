#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/analysis/quality/convergence_study.h"

namespace palpate::pipeline {

// What was measured of skeletons, for people and for programs.

/// A line a step, with a header.
std::string quality_table(const Quality& quality);

/// Format palpate-quality/1.
nlohmann::json quality_json(const Quality& quality);

/// The same numbers, a row a step.
std::string quality_csv(const Quality& quality);

/// Error against the number of spheres as SVG, both axes logarithmic: rms, median and 90th percentile of the probes.
std::string quality_plot(const Quality& quality, const std::string& name);

}  // namespace palpate::pipeline
