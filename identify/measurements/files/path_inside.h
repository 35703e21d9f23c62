#pragma once

#include <filesystem>
#include <string>

#include "mesh/core/surface.h"
#include "mesh/formats/yaml/yaml_fields.h"

namespace palpate::identify {

/// A file of the set: a set that was received from elsewhere must not reach out of its folder.
/// @throws InvalidInput where the path does; IoError where there is no such file.
std::filesystem::path path_inside(const mesh::YamlFields& fields, const std::string& key,
                                  const std::filesystem::path& folder);

/// The same of the files of points that some of the regions (mappings) name.
void check_region_paths(const std::vector<mesh::YamlFields>& regions, const std::filesystem::path& folder);

/// A closed surface out of a file, welded and turned outward. `where` begins a message, `what`: "the tool 'punch'".
/// @throws IoError, InvalidInput; for an open surface too, telling how many edges are open.
mesh::Surface read_closed_surface(const std::filesystem::path& file, double unit, const std::string& where,
                                  const std::string& what);

/// The same out of a file of the set, that a field of set.yaml names.
mesh::Surface read_closed_surface(const mesh::YamlFields& fields, const std::string& key,
                                  const std::filesystem::path& folder, double unit, const std::string& what);

}  // namespace palpate::identify
