#pragma once

#include <filesystem>

#include "mesh/formats/deck/cells.h"
#include "mesh/formats/vtk/vtk_data.h"

namespace palpate::mesh {

/// The solid cells of a grid; flat ones are left out.
/// @throws InvalidInput for another solid, or one of too few nodes.
Cells cells_of(const VtkData& grid, const std::filesystem::path& file);

}  // namespace palpate::mesh
