#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh/core/region.h"
#include "mesh/formats/yaml/yaml_fields.h"

namespace palpate::mesh {

/// A list of regions, each a mapping with one of
///   box: {min, max}   sphere: {center, radius}   plane: {point, normal, within}   points: {file, within}
/// `joined` (optional, of points): see PointsRegion. `file`: a CSV of x,y,z, relative to the YAML file. Lengths are
/// multiplied by `unit` [mm per unit of the file].
/// @throws InvalidInput naming file, line and field; for an empty list too.
std::vector<Region> read_regions(const YamlFields& yaml, const std::string& key, double unit);

/// One item of such a list.
Region read_region(const YamlFields& yaml, double unit);

/// The list as YAML in mm, a line per region, each line begun with `indent`; points are written out as
/// points: {at: [[x, y, z], ...], within: w}, which read_regions reads as well.
std::string regions_to_yaml(const std::vector<Region>& regions, const std::string& indent = "  ");

/// The same for a file in `folder`: more than a few points become a file beside it, <name>_1.csv and so on.
/// @throws IoError.
std::string regions_to_yaml_in(const std::filesystem::path& folder, const std::vector<Region>& regions,
                               const std::string& name = "held", const std::string& indent = "  ");

}  // namespace palpate::mesh
