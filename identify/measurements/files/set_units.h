#pragma once

#include <string>

#include "mesh/formats/yaml/yaml_fields.h"

namespace palpate::identify {

/// What one unit of the files is in ours.
struct SetUnits {
    std::string length_name = "mm", force_name = "N";  // as set.yaml tells them
    double length = 1;                                 // [mm]
    double force = 1;                                  // [N]
    double angle = 1;                                  // [rad]
    double pressure = 1;                               // [MPa]
    double moment = 1;                                 // [N mm]; where it is not told: force times length
};

/// `units` of a set.yaml; what is not told is mm, N, s, rad, MPa. @throws InvalidInput for units that are not known.
SetUnits read_units(const mesh::YamlFields& set);

}  // namespace palpate::identify
