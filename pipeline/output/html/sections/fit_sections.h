#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace palpate::pipeline {

// Sections of the report page on the fit itself; "" where a run has nothing to show there.

/// How the search and the particles went. `convergence`: identify/convergence.csv.
std::string convergence_section(const std::filesystem::path& convergence);

/// How well skeletons follow the body, over their number of spheres. `quality`: as `skeleton --quality` writes it, or
/// null.
std::string spheres_section(const nlohmann::json& quality);

}  // namespace palpate::pipeline
