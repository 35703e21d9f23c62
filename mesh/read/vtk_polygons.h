#pragma once

#include "mesh/io/vtk_data.h"
#include "mesh/read/polygons.h"

namespace palpate::mesh {

/// Polygons, triangles, quadrilaterals and strips of what a VTK file holds, by their corners.
Polygons polygons_of(const VtkData& data);

}  // namespace palpate::mesh
