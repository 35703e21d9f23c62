#pragma once

#include <string>

#include "mesh/core/material_region.h"

namespace palpate::pipeline {

/// A region as a flag tells it: "NAME:surface=FILE,young=MPA[,poisson=NU][,density=KG_M3]", its surface in the unit of
/// the body's mesh. @throws InvalidInput, IoError.
mesh::MaterialRegion read_region_spec(const std::string& spec);

}  // namespace palpate::pipeline
