#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mesh/core/surface.h"
#include "mesh/topology/check_surface.h"

namespace palpate::pipeline::commands {

/// Where faults of each kind are, the first few of them.
std::string describe_places(const std::vector<mesh::FaultPlace>& places);

/// The same for check.json.
nlohmann::json places_json(const std::vector<mesh::FaultPlace>& places);

/// For ParaView: the surface whose triangles tell their fault, and a point for each.
void write_faults(const std::filesystem::path& folder, const mesh::Surface& surface,
                  const std::vector<mesh::FaultPlace>& places);

}  // namespace palpate::pipeline::commands
