#pragma once

#include <filesystem>

#include "mesh/formats/vtk/vtk_data.h"

namespace palpate::mesh {

/// What a VTP file holds: points, the polygons and lines between them, and their arrays.
struct PolyData {
    Points points;                                // (n x 3)
    Triangles triangles;                          // (t x 3); polygons with more corners are left out
    Eigen::Matrix<int, Eigen::Dynamic, 2> lines;  // (l x 2); longer ones are left out
    MeshData data;
};

PolyData as_poly_data(VtkData data);

/// Of a file that this program wrote. @throws IoError when there is no such file, InvalidInput when it is no whole VTP
/// file.
PolyData read_poly_data(const std::filesystem::path& file);

/// The files of a series (.pvd) in their order. @throws IoError when there is no such file.
std::vector<SeriesStep> read_pvd(const std::filesystem::path& file);

}  // namespace palpate::mesh
