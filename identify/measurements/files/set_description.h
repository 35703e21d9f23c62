#pragma once

#include "identify/measurements/files/set_units.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/formats/yaml/yaml_fields.h"

namespace palpate::identify {

/// What set.yaml tells the tables' reader.
struct SetDescription {
    SetUnits units;
    bool is_first_format = true;
    std::optional<StateName> displacements_since;  // the state that displacements.csv counts from; absent: rest
};

/// Reads set.yaml, and the surfaces and points that it names, into `set`: all but markers and states.
SetDescription read_set_description(const std::filesystem::path& file, MeasurementSet& set);

/// What a set says of its body and of all states, which a map of an import says too: supports, density, history,
/// gravity, noise and material. @pre the set's folder is known. @throws InvalidInput.
void read_conditions(const mesh::YamlFields& fields, const SetUnits& units, MeasurementSet& set);

}  // namespace palpate::identify
