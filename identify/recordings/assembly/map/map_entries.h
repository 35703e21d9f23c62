#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "identify/measurements/files/set_units.h"
#include "identify/recordings/assembly/map/import_map.h"
#include "mesh/formats/yaml/yaml_fields.h"

namespace palpate::identify {

// Entries of a map.yaml, one by one.

/// A file that the map names: in the first of the folders that holds it, or as it stands.
/// @throws IoError telling where it was sought.
std::filesystem::path found_file(const std::string& name, const std::vector<std::filesystem::path>& folders,
                                 const std::string& where);

/// "mm", "cm", "m", "in" in mm.
double length_unit(const std::string& name);

/// A number with the unit that it is told in, as "10 kPa", in ours. @throws InvalidInput.
MappedValue parse_value(const std::string& name, const std::string& text, const std::string& where);

MappedFile read_mapped_file(const mesh::YamlFields& entry);

/// One more marker or fiducial. @throws InvalidInput where its name is told differently already.
void add_place(MappedPlace place, const std::string& where, ImportMap& map);
void read_places(const mesh::YamlFields& yaml, const char* key, double unit, bool are_markers, ImportMap& map);
void read_quantities(const mesh::YamlFields& yaml, ImportMap& map);

/// `forces`, `motions`, `reactions`, `actuations`. @pre tools and actuators are read.
void read_uses(const mesh::YamlFields& yaml, const SetUnits& units, ImportMap& map);

}  // namespace palpate::identify
