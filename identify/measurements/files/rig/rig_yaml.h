#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "identify/measurements/files/set_units.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

// Tools and actuators in a set.yaml: what each is, and where at rest.

/// Reads `tools` into the set; what is not told is assumed, and stands in its notes. @pre its surface is read.
/// @throws IoError, InvalidInput.
void read_tools(const mesh::YamlFields& yaml, const SetUnits& units, MeasurementSet& set);

/// Reads `actuators` into the set. @throws IoError, InvalidInput.
void read_actuators(const mesh::YamlFields& yaml, const SetUnits& units, MeasurementSet& set);

/// `tools:` in mm for a set.yaml in `folder`, and the files that it names there; "" where there is none. @throws
/// IoError.
std::string tools_to_yaml(const std::filesystem::path& folder, const std::vector<mesh::Tool>& tools);

/// `actuators:` likewise.
std::string actuators_to_yaml(const std::filesystem::path& folder, const std::vector<mesh::Actuator>& actuators);

/// The name of an item of a list, which tables will name it by. @throws InvalidInput where it is none, or not its own.
std::string read_own_name(const mesh::YamlFields& item, const std::vector<std::string>& taken);

/// A text in double quotes, as YAML reads it back whatever it holds.
std::string yaml_text(const std::string& text);

/// "[x, y, z]"
std::string yaml_list(const Vec3& v);

}  // namespace palpate::identify
