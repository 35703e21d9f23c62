#pragma once

#include <vector>

#include "mesh/core/material_region.h"

namespace palpate::mesh {

/// Labels of those regions that the body's file tells, in their order: the parts to ask `read_body` for.
std::vector<int> labels_of(const std::vector<MaterialRegion>& regions);

/// Gives those regions the surfaces of the parts, times `scale`. @pre as many parts as labels_of(), in that order.
void take_parts(const std::vector<Surface>& parts, double scale, std::vector<MaterialRegion>& regions);

}  // namespace palpate::mesh
