#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/identify.h"

namespace palpate::pipeline {

// Sections of the report page on the fit itself; "" where a run has nothing to show there.

/// Posteriors against priors, those that the data inform first. `file`: where all of them stand, within the run.
std::string stiffness_section(const std::vector<identify::PosteriorRow>& posterior, const std::string& file);

/// How the search and the particles went. `convergence`: identify/convergence.csv.
std::string convergence_section(const std::filesystem::path& convergence);

/// How well skeletons follow the body, over their number of spheres. `quality`: as `skeleton --quality` writes it, or
/// null.
std::string spheres_section(const nlohmann::json& quality);

}  // namespace palpate::pipeline
