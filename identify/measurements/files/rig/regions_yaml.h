#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "mesh/formats/yaml/yaml_fields.h"

namespace palpate::identify {

/// What `regions` of a set.yaml or a case.yaml tells: the surfaces in `unit` [mm]; those of regions by label are left
/// out until the body's file is read. Where the regions lie in the body is not looked at. @throws IoError,
/// InvalidInput.
/// Files lie in `folder`: those of a set nowhere else.
enum class RegionFiles { inside_folder, anywhere };
std::vector<mesh::MaterialRegion> read_material_regions(const mesh::YamlFields& yaml, double unit,
                                                        const std::filesystem::path& folder,
                                                        RegionFiles files = RegionFiles::inside_folder);

/// Regions that contradict the body or its supports. @param where begins a message: the file.
/// @throws InvalidInput, also for a region of unknown stiffness that is held altogether, which no reading could tell.
void check_material_regions(const std::vector<mesh::MaterialRegion>& regions, const mesh::Surface& body,
                            const std::vector<mesh::Region>& supports, const std::string& where);

/// `regions:` in mm for a set.yaml in `folder`, and the surfaces that it names there; "" where there is none.
/// @throws IoError.
std::string regions_to_yaml(const std::filesystem::path& folder, const std::vector<mesh::MaterialRegion>& regions);

}  // namespace palpate::identify
