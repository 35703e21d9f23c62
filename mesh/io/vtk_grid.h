#pragma once

#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <filesystem>

#include "mesh/io/vtk_files.h"
#include "mesh/types.h"

namespace palpate::mesh {

/// A VTU file as VTK holds it. @throws IoError, InvalidInput when it is no whole VTU file.
vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::filesystem::path& file);

/// Its points. @throws InvalidInput naming one that is not finite.
Points points_of(const std::filesystem::path& file, vtkUnstructuredGrid* grid);

/// Its arrays of points or cells, or those of the file; arrays of texts are left out.
std::vector<DataArray> arrays_of(vtkFieldData* source);

}  // namespace palpate::mesh
