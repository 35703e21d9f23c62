#pragma once

#include <string>
#include <vector>

#include "mesh/core/material_region.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// Gives a skeleton of one material the stiffness of its regions, as shares of the Young's modulus [MPa] that it was
/// built with; those whose modulus is unknown are as the rest. What was done, in words.
std::vector<std::string> take_regions(const std::vector<mesh::MaterialRegion>& regions, double young,
                                      skeleton::Model& model);

}  // namespace palpate::pipeline
