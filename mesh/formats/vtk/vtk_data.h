#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "mesh/formats/vtk/vtk_files.h"

namespace palpate::mesh {

/// What a VTK file holds, in plain arrays.
struct VtkData {
    Points points;                          // (n x 3)
    std::vector<int> types;                 // of each cell, VTK's number
    std::vector<std::int64_t> corners;      // of all cells, one after the other, each in [0, n)
    std::vector<std::int64_t> ends;         // where each cell's corners end
    std::vector<DataArray> of_points = {};  // a row a point; arrays of texts are left out
    std::vector<DataArray> of_cells = {};   // a row a cell
    std::vector<DataArray> of_file = {};

    std::span<const std::int64_t> cell(std::size_t c) const;
};

/// Poly data (.vtp) holds vertices, lines, polygons and strips in this order, whose types are VTK_POLY_VERTEX,
/// VTK_POLY_LINE, VTK_POLYGON and VTK_TRIANGLE_STRIP. A legacy file (.vtk) holds one or the other.
enum class VtkKind { unstructured_grid, poly_data, legacy };

/// A file that anybody may have written: a child process reads it and hands over what it holds.
/// @throws IoError when there is no such file. InvalidInput when it is no whole file of that kind, when its head
/// announces more than a thousand entries a byte, when it breaks VTK's reader, when a cell names a point that is not
/// there, or a grid's point is not finite.
VtkData read_vtk(const std::filesystem::path& file, VtkKind kind);

/// The same in this process, for what this program wrote itself.
VtkData read_own_vtk(const std::filesystem::path& file, VtkKind kind);

/// Is it one of VTK's kinds of cell, and of less than three dimensions?
bool is_flat(int type);

}  // namespace palpate::mesh
