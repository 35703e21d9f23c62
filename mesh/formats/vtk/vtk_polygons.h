#pragma once

#include "mesh/formats/surface/polygons.h"
#include "mesh/formats/vtk/vtk_data.h"

namespace palpate::mesh {

/// Polygons, triangles, quadrilaterals and strips of what a VTK file holds, by their corners.
Polygons polygons_of(const VtkData& data);

}  // namespace palpate::mesh
